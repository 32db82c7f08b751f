#include "tests/server/small_disk.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

namespace lightwell::test {
namespace fs = std::filesystem;

SmallDisk::SmallDisk(const fs::path& folder, uint64_t bytes) : folder_(folder) {
  const std::string size = "size=" + std::to_string(bytes), place = folder.string();
  int ready[2];
  if (pipe2(ready, O_CLOEXEC) != 0) return;
  holder_ = fork();
  if (holder_ == 0) {
    dup2(ready[1], STDOUT_FILENO);
    const char* const script = "mount -t tmpfs -o \"$1\" tmpfs \"$2\" && echo ready && exec sleep 3600";
    if (geteuid() == 0) execlp("unshare", "unshare", "--mount", "sh", "-c", script, "sh", size.c_str(), place.c_str(), nullptr);
    else execlp("unshare", "unshare", "--user", "--map-root-user", "--mount", "sh", "-c", script, "sh", size.c_str(), place.c_str(), nullptr);
    _exit(127);
  }
  close(ready[1]);
  char byte = 0;
  exists_ = read(ready[0], &byte, 1) == 1;
  close(ready[0]);
}

SmallDisk::~SmallDisk() {
  if (holder_ <= 0) return;
  kill(holder_, SIGKILL);
  waitpid(holder_, nullptr, 0);
}

std::vector<std::string> SmallDisk::launcher() const {
  std::vector<std::string> words{"nsenter", "--mount", "--target", std::to_string(holder_)};
  if (geteuid() != 0) words.insert(words.end(), {"--user", "--preserve-credentials"});
  words.push_back("--");
  return words;
}

fs::path SmallDisk::seenFromHere() const { return "/proc/" + std::to_string(holder_) + "/root" + folder_.string(); }

void SmallDisk::fill(uint64_t bytes) const {
  const fs::path file = seenFromHere() / "filler";
  const int fd = open(file.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  const std::string block(4096, 'f');
  while (fs::space(seenFromHere()).available > bytes)
    if (write(fd, block.data(), block.size()) != ssize_t(block.size())) break;
  close(fd);
}

void SmallDisk::makeRoom() const {
  std::error_code ignored;
  fs::remove(seenFromHere() / "filler", ignored);
}

}  // namespace lightwell::test
