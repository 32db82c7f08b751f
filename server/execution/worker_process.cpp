#include "server/execution/worker_process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "server/execution/worker.h"

namespace lightwell::server {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kPoll = std::chrono::milliseconds(50), kGrace = std::chrono::milliseconds(500);
constexpr size_t kStderrTail = 4096;

double secondsSince(Clock::time_point begin) { return std::chrono::duration<double>(Clock::now() - begin).count(); }

struct Pipe {
  int read_end = -1, write_end = -1;
  Pipe() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("no pipe for a worker: ") + std::strerror(errno));
    read_end = ends[0], write_end = ends[1];
  }
  ~Pipe() {
    if (read_end >= 0) close(read_end);
    if (write_end >= 0) close(write_end);
  }
};

}  // namespace

WorkerProcess::WorkerProcess(const std::filesystem::path& program, const v1::WorkerRequest& request) {
  Pipe input, events, errors;
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  // Through high numbers first: a pipe may have got one of the low ones.
  constexpr int kAway = 1000;
  const std::array<std::pair<int, int>, 3> ends{{{input.read_end, STDIN_FILENO}, {errors.write_end, STDERR_FILENO},
                                                 {events.write_end, kEventDescriptor}}};
  for (size_t i = 0; i < ends.size(); ++i) posix_spawn_file_actions_adddup2(&actions, ends[i].first, kAway + int(i));
  for (size_t i = 0; i < ends.size(); ++i) posix_spawn_file_actions_adddup2(&actions, kAway + int(i), ends[i].second);
  posix_spawn_file_actions_adddup2(&actions, STDERR_FILENO, STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions, kEventDescriptor + 1);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);
  const std::string path = program.string();
  std::string name = path;
  char* const argv[] = {name.data(), nullptr};
  const int error = posix_spawn(&pid_, path.c_str(), &actions, &attributes, argv, environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (error) {
    pid_ = -1;
    throw std::runtime_error("the worker " + path + " cannot be started: " + std::strerror(error));
  }
  input_ = std::exchange(input.write_end, -1);
  events_ = std::exchange(events.read_end, -1);
  errors_ = std::exchange(errors.read_end, -1);
  fcntl(events_, F_SETFL, O_NONBLOCK);
  fcntl(errors_, F_SETFL, O_NONBLOCK);
  writeMessage(input_, request);  // a worker that died before reading it is seen by wait()
}

WorkerProcess::~WorkerProcess() {
  if (pid_ > 0) {
    kill(pid_, SIGKILL);
    waitpid(pid_, nullptr, 0);
  }
  for (const int fd : {input_, events_, errors_})
    if (fd >= 0) close(fd);
}

void WorkerProcess::drainErrors() {
  char bytes[4096];
  ssize_t got;
  while ((got = read(errors_, bytes, sizeof bytes)) > 0) stderr_tail_.append(bytes, size_t(got));
  if (stderr_tail_.size() > kStderrTail) stderr_tail_.erase(0, stderr_tail_.size() - kStderrTail);
}

WorkerEnd WorkerProcess::wait(const WorkerLimits& limits, const std::function<void(const v1::WorkerEvent&)>& event,
                              const std::function<bool()>& should_stop) {
  WorkerEnd end;
  const auto begin = Clock::now();
  auto last_word = begin;
  Clock::time_point asked_to_stop{};
  const auto stop = [&](bool& why) {
    if (asked_to_stop != Clock::time_point()) return;
    why = true;
    asked_to_stop = Clock::now();
    kill(pid_, SIGTERM);
  };
  const auto takeEvents = [&] {
    v1::WorkerEvent message;
    while (reader_.next(message)) {
      last_word = Clock::now();
      if (message.has_done() || message.has_failed())
        end.last = message;
      else
        event(message);
      if (limits.memory_bytes && message.progress().memory_bytes() > limits.memory_bytes) stop(end.over_memory);
    }
  };
  for (bool open = true;;) {
    pollfd fds[] = {{open ? events_ : -1, POLLIN, 0}, {errors_, POLLIN, 0}};
    poll(fds, 2, int(kPoll.count()));
    if (fds[0].revents) {
      open = reader_.readSome(events_);
      takeEvents();
    }
    if (fds[1].revents) drainErrors();
    int status = 0;
    if (waitpid(pid_, &status, WNOHANG) == pid_) {
      while (open && reader_.readSome(events_)) {
        takeEvents();
        pollfd rest{events_, POLLIN, 0};
        if (poll(&rest, 1, 0) <= 0) break;
      }
      takeEvents();
      drainErrors();
      pid_ = -1;
      if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
      else end.exit_code = WEXITSTATUS(status);
      end.stderr_tail = stderr_tail_;
      return end;
    }
    if (should_stop()) stop(end.stopped);
    if (limits.wall_s > 0 && secondsSince(begin) > limits.wall_s) stop(end.timed_out);
    if (limits.heartbeat_s > 0 && secondsSince(last_word) > limits.heartbeat_s) stop(end.heartbeat_lost);
    if (asked_to_stop != Clock::time_point() && Clock::now() - asked_to_stop > kGrace) kill(pid_, SIGKILL);
  }
}

}  // namespace lightwell::server
