#include "precompute/bake/result_store.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <system_error>

namespace lightwell::bake {
namespace fs = std::filesystem;

Blob MemoryStore::get(const Key& key) {
  std::lock_guard lock(mutex_);
  const auto found = results_.find(key);
  return found == results_.end() ? nullptr : found->second;
}

void MemoryStore::put(const Key& key, const Blob& result) {
  std::lock_guard lock(mutex_);
  results_.emplace(key, result);
}

namespace {

// File: magic, payload size, XXH3-128 of the payload (high, low), payload; host byte order, since a cache stays with its machines.
constexpr char kMagic[8] = {'L', 'W', 'T', 'A', 'S', 'K', '1', '\n'};
struct FileHeader {
  char magic[8];
  uint64_t size, checksum_high, checksum_low;
};

void removeAbandonedFiles(const fs::path& folder) {
  std::error_code ignored;
  const auto yesterday = fs::file_time_type::clock::now() - std::chrono::hours(24);
  for (const auto& entry : fs::directory_iterator(folder, ignored))
    if (const auto written = entry.last_write_time(ignored); !ignored && written < yesterday) fs::remove(entry.path(), ignored);
}

}  // namespace

DirectoryStore::DirectoryStore(fs::path folder, Diagnostics& diagnostics) : folder_(std::move(folder)), diagnostics_(diagnostics) {
  std::error_code error;
  fs::create_directories(folder_ / "tmp", error);
  if (error || access((folder_ / "tmp").c_str(), W_OK) != 0)
    throw UsageError("cannot write to the cache folder " + folder_.string() + ": " + (error ? error.message() : std::strerror(errno)));
  removeAbandonedFiles(folder_ / "tmp");
}

fs::path DirectoryStore::fileOf(const Key& key) const {
  const std::string hex = key.hex();
  return folder_ / hex.substr(0, 2) / hex.substr(2);
}

Blob DirectoryStore::get(const Key& key) {
  std::ifstream in(fileOf(key), std::ios::binary | std::ios::ate);
  if (!in) return nullptr;
  const std::streamoff file_size = in.tellg();
  in.seekg(0);
  FileHeader header;
  if (!in.read(reinterpret_cast<char*>(&header), sizeof header) || std::memcmp(header.magic, kMagic, sizeof kMagic) != 0) return nullptr;
  if (file_size < std::streamoff(sizeof header) || uint64_t(file_size) - sizeof header != header.size) return nullptr;
  auto bytes = std::make_shared<Bytes>(header.size);
  if (!in.read(reinterpret_cast<char*>(bytes->data()), std::streamsize(header.size))) return nullptr;
  if (hashBytes(*bytes) != Key{header.checksum_high, header.checksum_low}) return nullptr;
  // Who keeps the folder small looks at the time of the last use.
  std::error_code ignored;
  fs::last_write_time(fileOf(key), fs::file_time_type::clock::now(), ignored);
  return bytes;
}

void DirectoryStore::put(const Key& key, const Blob& result) {
  static std::atomic<uint64_t> serial{0};  // only keeps temporary names of this process apart
  const fs::path file = fileOf(key);
  const fs::path temporary = folder_ / "tmp" / (key.hex() + "." + std::to_string(getpid()) + "." + std::to_string(serial++));
  const Key checksum = hashBytes(*result);
  FileHeader header{{}, result->size(), checksum.high, checksum.low};
  std::memcpy(header.magic, kMagic, sizeof kMagic);
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  // No fsync: after a power failure the checksum tells, and the task runs again.
  std::ofstream out(temporary, std::ios::binary);
  out.write(reinterpret_cast<const char*>(&header), sizeof header);
  out.write(reinterpret_cast<const char*>(result->data()), std::streamsize(result->size()));
  out.close();
  if (out) fs::rename(temporary, file, error);
  if (!out || error) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    std::call_once(warned_, [&] {
      diagnostics_.warn(folder_.string(), "results cannot be written to the cache" + (error ? " (" + error.message() + ")" : "") +
                                              "; the bake goes on without them");
    });
  }
}

}  // namespace lightwell::bake
