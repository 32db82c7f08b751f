// Where the bytes of a container come from, and where the decoder's own memory comes from.
#pragma once
#include <cstddef>
#include <cstdint>

namespace lightwell::format {

/// A random-access byte source. `read` fills all of [destination, destination + bytes) from `offset` or returns false; it must be safe to
/// call from several threads if the View is used from several. The decoder never reads at or past `bytes`.
struct Source {
  bool (*read)(void* user, uint64_t offset, void* destination, size_t bytes) = nullptr;
  void* user = nullptr;
  uint64_t bytes = 0;               // of the whole source
  const uint8_t* memory = nullptr;  // when all of it lies in memory: the decoder then reads in place, and `read` may be null
};

/// `data` must outlive every View opened on it and must not change.
Source memorySource(const void* data, size_t bytes);

/// A file opened for reading (pread: safe from several threads). Closes itself.
class FileSource {
 public:
  FileSource() = default;
  ~FileSource();
  FileSource(FileSource&& other) noexcept;
  FileSource& operator=(FileSource&& other) noexcept;
  /// False when the path is not a readable regular file; errno then says why.
  bool open(const char* path);
  /// Valid while the file is open; moving this object does not matter.
  Source source() const;

 private:
  int descriptor_ = -1;
  uint64_t bytes_ = 0;
};

/// Null functions: malloc and free. With `allocate` alone nothing is released. `allocate` returns memory aligned to 16 bytes, or null.
struct Allocator {
  void* (*allocate)(void* user, size_t bytes) = nullptr;
  void (*release)(void* user, void* memory) = nullptr;
  void* user = nullptr;
};

void* allocate(const Allocator& allocator, size_t bytes);
void release(const Allocator& allocator, void* memory);  // null does nothing

/// What a file may ask for at most. Checked before anything of that size is allocated.
struct Limits {
  uint64_t file_bytes = uint64_t(1) << 40;       // 1 TiB
  uint64_t directory_bytes = uint64_t(16) << 20;  // 16 MiB
  uint32_t sections = 256;
  uint32_t chunks = 65536;
  uint64_t decoded_bytes = uint64_t(2) << 30;     // 2 GiB, over all chunks of the file together
};

}  // namespace lightwell::format
