// One worker process, from the daemon's side.
#pragma once
#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <string>

#include "lightwell/v1/service_worker.pb.h"
#include "server/execution/framing.h"

namespace lightwell::server {

/// How a worker ended. Its own word (`last`) counts only if it ended by itself.
struct WorkerEnd {
  v1::WorkerEvent last;      // done or failed; neither when it gave none
  int signal = 0;            // that ended it; 0: none
  int exit_code = 0;
  std::string stderr_tail;
  bool heartbeat_lost = false, timed_out = false, over_memory = false, stopped = false;  // why we ended it
};

struct WorkerLimits {
  double wall_s = 0;
  uint64_t memory_bytes = 0;
  double heartbeat_s = 20;   // without a word for so long, it is taken for dead
};

class WorkerProcess {
 public:
  /// Starts `program` in its own process group, with nothing of ours open but its pipes. Call from a thread that outlives the worker: when
  /// that thread ends, so does the worker. Throws std::runtime_error.
  WorkerProcess(const std::filesystem::path& program, const v1::WorkerRequest& request);
  /// Kills it if it still runs.
  ~WorkerProcess();
  WorkerProcess(const WorkerProcess&) = delete;
  WorkerProcess& operator=(const WorkerProcess&) = delete;

  pid_t pid() const { return pid_; }

  /// Waits for its end, telling `event` of progress and warnings. `should_stop` is asked several times a second; once true, the worker gets
  /// SIGTERM, and SIGKILL half a second later. No process is left on return.
  WorkerEnd wait(const WorkerLimits& limits, const std::function<void(const v1::WorkerEvent&)>& event,
                 const std::function<bool()>& should_stop);

 private:
  void drainErrors();
  pid_t pid_ = -1;
  int input_ = -1, events_ = -1, errors_ = -1;
  MessageReader reader_;
  std::string stderr_tail_;
};

}  // namespace lightwell::server
