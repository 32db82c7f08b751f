#include "format/decode/source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <utility>

namespace lightwell::format {
namespace {

bool readDescriptor(void* user, uint64_t offset, void* destination, size_t bytes) {
  const int descriptor = int(reinterpret_cast<intptr_t>(user));
  auto* out = static_cast<uint8_t*>(destination);
  while (bytes > 0) {
    const ssize_t got = ::pread(descriptor, out, bytes, off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;  // an error, or a file that became shorter
    out += got;
    offset += uint64_t(got);
    bytes -= size_t(got);
  }
  return true;
}

}  // namespace

Source memorySource(const void* data, size_t bytes) {
  static const uint8_t nothing = 0;
  Source source;
  source.bytes = bytes;
  source.memory = data ? static_cast<const uint8_t*>(data) : &nothing;
  return source;
}

void* allocate(const Allocator& allocator, size_t bytes) {
  return allocator.allocate ? allocator.allocate(allocator.user, bytes) : std::malloc(bytes);
}
void release(const Allocator& allocator, void* memory) {
  if (!memory) return;
  if (allocator.release) allocator.release(allocator.user, memory);
  else if (!allocator.allocate) std::free(memory);  // an allocator without release frees all at once, later
}

FileSource::~FileSource() {
  if (descriptor_ >= 0) ::close(descriptor_);
}
FileSource::FileSource(FileSource&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)), bytes_(std::exchange(other.bytes_, 0)) {}
FileSource& FileSource::operator=(FileSource&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(bytes_, other.bytes_);
  return *this;
}

bool FileSource::open(const char* path) {
  // Non-blocking, so that a FIFO is refused instead of waited for.
  const int descriptor = ::open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) return false;
  struct stat info = {};
  if (::fstat(descriptor, &info) != 0 || !S_ISREG(info.st_mode)) {
    ::close(descriptor);
    errno = S_ISDIR(info.st_mode) ? EISDIR : EINVAL;
    return false;
  }
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = descriptor;
  bytes_ = uint64_t(info.st_size);
  return true;
}

Source FileSource::source() const {
  Source source;
  source.read = readDescriptor;
  source.user = reinterpret_cast<void*>(intptr_t(descriptor_));
  source.bytes = bytes_;
  return source;
}

}  // namespace lightwell::format
