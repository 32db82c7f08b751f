#include "tests/server/daemon_process.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

namespace lightwell::test {
namespace fs = std::filesystem;

int freePort() {
  const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  EXPECT_EQ(bind(fd, reinterpret_cast<sockaddr*>(&address), size), 0);
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  close(fd);
  return ntohs(address.sin_port);
}

namespace {

/// State letter and parent of a process; '-' when there is none.
std::pair<char, pid_t> stateOf(const std::string& pid) {
  std::ifstream in("/proc/" + pid + "/stat");
  const std::string stat((std::istreambuf_iterator<char>(in)), {});
  const size_t after_name = stat.rfind(')');
  if (after_name == std::string::npos) return {'-', 0};
  std::istringstream fields(stat.substr(after_name + 1));
  char state = '-';
  pid_t parent = 0;
  fields >> state >> parent;
  return {state, parent};
}

}  // namespace

std::vector<pid_t> childrenOf(pid_t pid) {
  std::vector<pid_t> children;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator("/proc", error)) {
    const std::string name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (const auto [state, parent] = stateOf(name); parent == pid && state != 'Z') children.push_back(pid_t(std::stol(name)));
  }
  return children;
}

bool isAlive(pid_t pid) {
  const char state = stateOf(std::to_string(pid)).first;
  return state != '-' && state != 'Z' && state != 'X';
}

DaemonProcess::DaemonProcess(const fs::path& data, std::vector<std::string> more, bool test_worker, std::vector<std::string> launcher)
    : data_(data), more_(std::move(more)), launcher_(std::move(launcher)), test_worker_(test_worker), port_(freePort()), http_port_(freePort()) {
  start();
}

DaemonProcess::~DaemonProcess() {
  if (pid_ > 0) kill();
}

void DaemonProcess::start() {
  std::vector<std::string> words = launcher_;
  words.insert(words.end(), {LIGHTWELLD_PROGRAM, "--data", data_.string(), "--listen", address(), "--http",
                             "127.0.0.1:" + std::to_string(http_port_)});
  if (test_worker_) words.insert(words.end(), {"--worker-program", LIGHTWELL_TEST_WORKER});
  words.insert(words.end(), more_.begin(), more_.end());
  std::vector<char*> argv;
  for (auto& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string log_file = data_.string() + ".log";
  pid_ = fork();
  if (pid_ == 0) {
    dup2(open(log_file.c_str(), O_CREAT | O_WRONLY | O_APPEND, 0600), STDERR_FILENO);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  // The ports accept once it serves.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  for (const int port : {port_, http_port_}) {
    bool connected = false;
    while (!connected && std::chrono::steady_clock::now() < deadline && running()) {
      const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(uint16_t(port));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      connected = connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
      close(fd);
      if (!connected) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    ASSERT_TRUE(connected) << log();
  }
}

bool DaemonProcess::running() {
  if (pid_ <= 0) return false;
  siginfo_t info{};
  return waitid(P_PID, id_t(pid_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid == 0;
}

void DaemonProcess::kill() {
  ::kill(pid_, SIGKILL);
  waitpid(std::exchange(pid_, -1), nullptr, 0);
}

int DaemonProcess::terminate(double* seconds) {
  const auto begin = std::chrono::steady_clock::now();
  ::kill(pid_, SIGTERM);
  int status = 0;
  waitpid(std::exchange(pid_, -1), &status, 0);
  if (seconds) *seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string DaemonProcess::log() const {
  std::ifstream in(data_.string() + ".log");
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<pid_t> DaemonProcess::workers() const { return childrenOf(pid_); }

size_t DaemonProcess::openDescriptors() const {
  std::error_code error;
  size_t count = 0;
  for ([[maybe_unused]] const auto& entry : fs::directory_iterator("/proc/" + std::to_string(pid_) + "/fd", error)) ++count;
  return count;
}

uint64_t DaemonProcess::residentBytes() const {
  std::ifstream statm("/proc/" + std::to_string(pid_) + "/statm");
  uint64_t pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * uint64_t(sysconf(_SC_PAGESIZE));
}

server::ClientOptions clientOptions(const DaemonProcess& daemon) {
  server::ClientOptions options;
  options.server = daemon.address();
  options.patience_s = 10;
  return options;
}

v1::JobSpec quickSpec(const std::vector<server::LocalFile>& files, int seed) {
  v1::JobSpec spec;
  for (const auto& file : files) {
    v1::SceneFile& named = *spec.add_files();
    named.set_name(file.name);
    named.set_sha256(file.sha256);
    named.set_size(file.size);
  }
  spec.set_scene(files.at(0).name);
  spec.set_settings_json(R"({"lightmap_size": 24, "quality": "draft", "seed": )" + std::to_string(seed) + "}");
  return spec;
}

}  // namespace lightwell::test
