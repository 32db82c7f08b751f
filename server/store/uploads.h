// Files on their way in: partial until their content is what their name says.
#pragma once
#include <filesystem>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "server/failure.h"
#include "server/store/blob_store.h"
#include "server/store/job_store.h"
#include "server/store/sha256.h"

namespace lightwell::server {

struct UploadLimits {
  uint64_t max_file_bytes = 0;
  uint64_t max_client_bytes = 0;  // of all uploads of one client that are still kept
};

class Uploads;

/// One stream. Destroyed before finish(), it leaves what came, to go on later.
class Upload {
 public:
  ~Upload();
  Upload(const Upload&) = delete;
  Upload& operator=(const Upload&) = delete;
  /// Throws Failure: upload_too_large (more than announced), disk_full.
  void add(std::string_view data);
  uint64_t received() const { return received_; }
  /// Stores the whole as a blob, synced. When bytes are missing the partial file stays, and the state says so. Throws Failure:
  /// hash_mismatch (what came is then forgotten), disk_full.
  v1::UploadState finish();

 private:
  friend class Uploads;
  Upload(Uploads& owner, std::filesystem::path file, std::string client, std::string sha256, uint64_t size);
  Uploads& owner_;
  const std::filesystem::path file_;
  const std::string client_, sha256_;
  const uint64_t size_;
  Sha256 hash_;
  uint64_t received_ = 0;
  int fd_ = -1;
};

/// Thread-safe. Partial files are kept apart by client: nobody can spoil another's upload.
class Uploads {
 public:
  /// `make_room(bytes)` makes room in the store, or returns false.
  Uploads(std::filesystem::path folder, BlobStore& blobs, JobStore& jobs, const UploadLimits& limits,
          std::function<bool(uint64_t)> make_room);

  v1::UploadState find(const std::string& client, const std::string& sha256);
  /// Null when the file is there already. Throws Failure: invalid_request, upload_too_large, upload_in_use, offset_mismatch,
  /// quota_exceeded, store_full, disk_full.
  std::unique_ptr<Upload> begin(const std::string& client, const std::string& sha256, uint64_t size, uint64_t offset);
  /// Removes partial files that have not grown for so long.
  void removeStale(double seconds);
  uint64_t partialBytes() const;

 private:
  friend class Upload;
  std::filesystem::path fileOf(const std::string& client, const std::string& sha256) const;
  const std::filesystem::path folder_;
  BlobStore& blobs_;
  JobStore& jobs_;
  const UploadLimits limits_;
  const std::function<bool(uint64_t)> make_room_;
  std::mutex mutex_;
  std::set<std::filesystem::path> active_;
};

}  // namespace lightwell::server
