#include "format/encode/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>

namespace lightwell::format {
namespace {

using Pieces = std::span<const std::span<const uint8_t>>;

struct Descriptor {
  int fd = -1;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

[[noreturn]] void fail(const std::filesystem::path& file, const char* action, int error) {
  throw std::runtime_error(file.string() + ": " + action + ": " + std::strerror(error));
}

/// False with errno set.
bool writeAll(int fd, Pieces pieces) {
  for (std::span<const uint8_t> piece : pieces)
    while (!piece.empty()) {
      const ssize_t written = ::write(fd, piece.data(), piece.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return false;
      piece = piece.subspan(size_t(written));
    }
  return ::fsync(fd) == 0;
}

/// A name in `folder` that nothing else uses: process and a counter; existing names are stepped over by the caller.
std::filesystem::path temporaryName(const std::filesystem::path& file, int attempt) {
  std::string name = file.filename().string();
  name.insert(0, 1, '.').append(".").append(std::to_string(::getpid())).append("-").append(std::to_string(attempt)).append(".tmp");
  return file.parent_path() / name;
}

/// Gives the nameless file a name. Empty path when the system cannot.
std::filesystem::path nameIt(int fd, const std::filesystem::path& file) {
  std::string self = "/proc/self/fd/";
  self += std::to_string(fd);
  for (int attempt = 0; attempt < 100; ++attempt) {
    std::filesystem::path name = temporaryName(file, attempt);
    if (::linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) return name;
    if (errno != EEXIST) break;
  }
  return {};
}

void renameInto(const std::filesystem::path& temporary, const std::filesystem::path& file, const std::filesystem::path& folder) {
  if (::rename(temporary.c_str(), file.c_str()) != 0) {
    const int error = errno;
    ::unlink(temporary.c_str());
    fail(file, "cannot be replaced", error);
  }
  // The name itself reaches the disk with its folder. Some file systems cannot sync folders; the data is safe by then.
  const Descriptor directory{::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (directory.fd >= 0) ::fsync(directory.fd);
}

}  // namespace

void writeFileAtomically(const std::filesystem::path& file, Pieces pieces) {
  struct stat existing;
  if (::stat(file.c_str(), &existing) == 0 && !S_ISREG(existing.st_mode))
    fail(file, "cannot be replaced", S_ISDIR(existing.st_mode) ? EISDIR : EINVAL);
  // A symbolic link stays; what it points to is replaced.
  std::error_code no_link;
  const std::filesystem::path target = std::filesystem::weakly_canonical(file, no_link);
  const std::filesystem::path path = no_link ? std::filesystem::absolute(file) : target;
  const std::filesystem::path folder = path.parent_path();

#ifdef O_TMPFILE
  {
    const Descriptor nameless{::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666)};
    if (nameless.fd >= 0) {
      if (!writeAll(nameless.fd, pieces)) fail(file, "cannot be written", errno);
      const std::filesystem::path temporary = nameIt(nameless.fd, path);
      if (!temporary.empty()) return renameInto(temporary, path, folder);
    }
  }
#endif
  std::filesystem::path temporary;
  Descriptor named;
  for (int attempt = 0; named.fd < 0; ++attempt) {
    temporary = temporaryName(path, attempt);
    named.fd = ::open(temporary.c_str(), O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
    if (named.fd < 0 && (errno != EEXIST || attempt == 100)) fail(file, "cannot be written", errno);
  }
  if (!writeAll(named.fd, pieces)) {
    const int error = errno;
    ::unlink(temporary.c_str());
    fail(file, "cannot be written", error);
  }
  renameInto(temporary, path, folder);
}

}  // namespace lightwell::format
