// Files by content: uploaded scenes, baked containers, previews. A blob's name is its SHA-256; nothing else ever names a file here.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lightwell::server {

/// Any number of processes may share the folder: blobs appear whole, by rename, and never change.
class BlobStore {
 public:
  /// Creates the folder.
  explicit BlobStore(std::filesystem::path folder);

  /// Where the blob lies, or would lie. `sha256` must pass isSha256().
  std::filesystem::path fileOf(const std::string& sha256) const;
  /// Its size; none when it is not there.
  std::optional<uint64_t> size(const std::string& sha256) const;
  /// Stores bytes, synced to the disk, and returns their name. Throws std::runtime_error naming the reason (disk full …).
  std::string put(std::span<const uint8_t> bytes);
  /// Takes over a finished file of the same file system whose content has this name.
  void adopt(const std::filesystem::path& file, const std::string& sha256);
  void remove(const std::string& sha256);

  struct Entry {
    std::string sha256;
    uint64_t size;
  };
  /// What is in the folder.
  std::vector<Entry> entries() const;

 private:
  std::filesystem::path folder_;
};

/// Flushes a file's data, or a folder's names, to the disk. Throws std::runtime_error.
void syncToDisk(const std::filesystem::path& path);

}  // namespace lightwell::server
