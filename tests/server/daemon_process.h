// A lightwelld of its own, as a process: on free ports, in a temporary folder, to be killed at will.
#pragma once
#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "server/client/client.h"

namespace lightwell::test {

int freePort();

class DaemonProcess {
 public:
  /// Starts and waits until it serves. `more` are further options; `test_worker`: instead of the real one; `launcher`: a command that
  /// becomes the one that follows it.
  explicit DaemonProcess(const std::filesystem::path& data, std::vector<std::string> more = {}, bool test_worker = false,
                         std::vector<std::string> launcher = {});
  ~DaemonProcess();
  DaemonProcess(const DaemonProcess&) = delete;
  DaemonProcess& operator=(const DaemonProcess&) = delete;

  /// Again, on the same ports and folder.
  void start();
  /// SIGKILL, and gone on return. Its workers may be about to die.
  void kill();
  /// SIGTERM; returns the exit code (-1: a signal). `seconds` receives how long it took.
  int terminate(double* seconds = nullptr);
  bool running();

  pid_t pid() const { return pid_; }
  std::string address() const { return "127.0.0.1:" + std::to_string(port_); }
  int httpPort() const { return http_port_; }
  const std::filesystem::path& data() const { return data_; }
  std::string log() const;
  /// Process ids of its workers.
  std::vector<pid_t> workers() const;
  size_t openDescriptors() const;
  uint64_t residentBytes() const;

 private:
  const std::filesystem::path data_;
  const std::vector<std::string> more_, launcher_;
  const bool test_worker_;
  const int port_, http_port_;
  pid_t pid_ = -1;
};

/// Children of a process, by /proc.
std::vector<pid_t> childrenOf(pid_t pid);

/// Whether a process runs: one that is dead but not waited for does not.
bool isAlive(pid_t pid);

/// A client of it, in this process.
server::ClientOptions clientOptions(const DaemonProcess& daemon);

/// The files and spec of a scene with quick settings.
v1::JobSpec quickSpec(const std::vector<server::LocalFile>& files, int seed = 1);

}  // namespace lightwell::test
