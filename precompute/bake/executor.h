// Runs the tasks of a graph that are needed for its goals.
#pragma once
#include <chrono>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "precompute/bake/result_store.h"
#include "precompute/bake/task_graph.h"

namespace lightwell::bake {

struct Progress {
  std::string phase;         // of the task that was last started
  size_t tasks_done = 0;     // reused ones included
  size_t tasks_total = 0;    // needed for the goals
  size_t tasks_reused = 0;   // found in the store
  double fraction = 0;       // of the expected work, 0 to 1
  double elapsed_s = 0;
  double eta_s = -1;         // expected seconds to the end; negative while unknown
};

struct PhaseTime {
  std::string name;
  double seconds;  // wall clock; where phases overlap, each gets its share of the running tasks, so that they sum to the whole
};

/// The work did not end before RunOptions::deadline.
class DeadlinePassed : public std::runtime_error {
 public:
  DeadlinePassed() : std::runtime_error("the deadline passed") {}
};

struct RunOptions {
  const CancelFlag* cancel = nullptr;
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  /// Called at least twice a second while tasks run, from one thread at a time.
  std::function<void(const Progress&)> progress;
};

struct RunResult {
  std::vector<Blob> goals;        // in the order asked for
  std::vector<PhaseTime> phases;  // in the order of their first task in the graph; only those that ran
  std::vector<PhaseTime> sections;  // likewise by section, the part of a task's id before its first '/', without what measures it
  size_t tasks_run = 0, tasks_reused = 0;
};

/// Tasks whose result is in the store are not run, nor is anything that only they would need. Results no longer needed are dropped.
/// The bytes do not depend on the executor. Throws Cancelled, DeadlinePassed, or the exception of a failed task (of several: the earliest
/// in the graph).
class Executor {
 public:
  virtual ~Executor() = default;
  virtual RunResult run(const TaskGraph& graph, std::span<const TaskIndex> goals, ResultStore& store, const RunOptions& options) = 0;
};

/// In this process, one task per thread.
class ThreadExecutor : public Executor {
 public:
  /// 0: one thread per processor of the machine.
  explicit ThreadExecutor(int threads = 0);
  RunResult run(const TaskGraph& graph, std::span<const TaskIndex> goals, ResultStore& store, const RunOptions& options) override;

 private:
  int threads_;
};

}  // namespace lightwell::bake
