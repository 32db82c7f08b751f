// Where the results of tasks are kept, by key. Resume, caches and the service are the same bake with another store.
#pragma once
#include <filesystem>
#include <map>
#include <mutex>

#include "precompute/bake/task_graph.h"

namespace lightwell::bake {

/// Thread-safe. A result that was put may be forgotten at any time, but never changes.
class ResultStore {
 public:
  virtual ~ResultStore() = default;
  /// The result of `key`, or null when it is not (or no longer, or not soundly) stored.
  virtual Blob get(const Key& key) = 0;
  virtual void put(const Key& key, const Blob& result) = 0;
};

/// Remembers nothing: a bake without a cache.
class NullStore : public ResultStore {
 public:
  Blob get(const Key&) override { return nullptr; }
  void put(const Key&, const Blob&) override {}
};

/// In this process's memory.
class MemoryStore : public ResultStore {
 public:
  Blob get(const Key& key) override;
  void put(const Key& key, const Blob& result) override;

 private:
  std::mutex mutex_;
  std::map<Key, Blob> results_;
};

/// A folder of files named by key, shared by any number of processes: each file appears whole, by rename, and carries a checksum; one
/// that does not match is ignored and rewritten. A file's time of writing is that of its last use. Deleting files or the whole folder
/// at any time is safe.
class DirectoryStore : public ResultStore {
 public:
  /// Creates the folder. Throws UsageError when it cannot be written. A failure to write a result later is a warning, reported
  /// once to `diagnostics` (which must outlive the store): the bake goes on without it.
  DirectoryStore(std::filesystem::path folder, Diagnostics& diagnostics);
  Blob get(const Key& key) override;
  void put(const Key& key, const Blob& result) override;
  /// The file that holds, or would hold, the result of `key`.
  std::filesystem::path fileOf(const Key& key) const;

 private:
  std::filesystem::path folder_;
  Diagnostics& diagnostics_;
  std::once_flag warned_;
};

}  // namespace lightwell::bake
