// How the store stays within its size: what can be made again or is of no use any more goes, the longest unused first.
#pragma once
#include <filesystem>
#include <mutex>

#include "server/store/blob_store.h"
#include "server/store/job_store.h"

namespace lightwell::server {

struct RetentionLimits {
  uint64_t max_store_bytes = 0;  // blobs, partial uploads and task results together
  double upload_keep_s = 0;      // an upload is kept for so long after its last use, whatever happens
  double finished_keep_s = 0;    // finished jobs are deleted after so long
  double partial_keep_s = 0;     // partial uploads likewise
};

/// Thread-safe. Task results go first (they only save time), then blobs that nothing refers to.
class Retention {
 public:
  /// Removes blobs that the database does not know, and forgets those whose file is gone.
  Retention(std::filesystem::path task_folder, std::filesystem::path upload_folder, BlobStore& blobs, JobStore& jobs,
            const RetentionLimits& limits);

  /// Whether so many more bytes fit, after removing what can be removed.
  bool makeRoom(uint64_t bytes);
  /// Deletes old jobs, and brings the store back under its limit. Called now and then.
  void sweep();
  uint64_t storeBytes();

 private:
  void reconcile();
  uint64_t removeTaskResults(uint64_t bytes);
  uint64_t removeBlobs(uint64_t bytes);
  const std::filesystem::path task_folder_, upload_folder_;
  BlobStore& blobs_;
  JobStore& jobs_;
  const RetentionLimits limits_;
  std::mutex mutex_;
  uint64_t task_bytes_ = 0;  // at the last look
};

/// Bytes of all regular files below a folder.
uint64_t folderBytes(const std::filesystem::path& folder);

}  // namespace lightwell::server
