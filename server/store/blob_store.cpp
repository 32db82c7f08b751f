#include "server/store/blob_store.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include "format/encode/atomic_file.h"
#include "server/store/sha256.h"

namespace lightwell::server {
namespace fs = std::filesystem;

void syncToDisk(const fs::path& path) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = fd >= 0 && fsync(fd) == 0;
  const int error = errno;
  if (fd >= 0) close(fd);
  if (!synced) throw std::runtime_error(path.string() + ": cannot be written: " + std::strerror(error));
}

BlobStore::BlobStore(fs::path folder) : folder_(std::move(folder)) { fs::create_directories(folder_); }

fs::path BlobStore::fileOf(const std::string& sha256) const {
  if (!isSha256(sha256)) throw std::logic_error("not the name of a blob");
  return folder_ / sha256.substr(0, 2) / sha256.substr(2);
}

std::optional<uint64_t> BlobStore::size(const std::string& sha256) const {
  std::error_code error;
  const uint64_t size = fs::file_size(fileOf(sha256), error);
  return error ? std::nullopt : std::optional(size);
}

std::string BlobStore::put(std::span<const uint8_t> bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  const std::string name = hash.finish();
  if (size(name) == bytes.size()) return name;
  const fs::path file = fileOf(name);
  fs::create_directories(file.parent_path());
  format::writeFileAtomically(file, bytes);
  return name;
}

void BlobStore::adopt(const fs::path& file, const std::string& sha256) {
  const fs::path target = fileOf(sha256);
  fs::create_directories(target.parent_path());
  syncToDisk(file);
  fs::rename(file, target);
  syncToDisk(target.parent_path());
}

void BlobStore::remove(const std::string& sha256) {
  std::error_code ignored;
  fs::remove(fileOf(sha256), ignored);
}

std::vector<BlobStore::Entry> BlobStore::entries() const {
  std::vector<Entry> entries;
  std::error_code error;
  for (const auto& folder : fs::directory_iterator(folder_, error)) {
    if (!folder.is_directory(error)) continue;
    for (const auto& file : fs::directory_iterator(folder.path(), error)) {
      const std::string name = folder.path().filename().string() + file.path().filename().string();
      const uint64_t size = file.file_size(error);
      if (!error && isSha256(name)) entries.push_back({name, size});
    }
  }
  return entries;
}

}  // namespace lightwell::server
