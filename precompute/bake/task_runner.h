// The graphs of one bake, run one after another as if they were one.
//
// What a graph looks like may depend on results: how many clusters there are, say, on the atlas. Such results are goals of graphs of their
// own, run while the next one is prepared; they are kept, reused and counted like all others.
#pragma once
#include <map>
#include <string>

#include "precompute/bake/executor.h"

namespace lightwell::bake {

class TaskRunner {
 public:
  /// Both outlive the runner. `options` hold for all graphs; progress counts the tasks of all of them.
  TaskRunner(Executor& executor, ResultStore& store, RunOptions options);

  /// Runs a graph whose results the next graphs are made with; while it runs, nobody knows yet how much work there is. Throws as
  /// Executor::run.
  std::vector<Blob> prepare(const TaskGraph& graph, std::span<const TaskIndex> goals);
  /// Runs a graph that answers; `deadline` holds for it alone.
  RunResult run(const TaskGraph& graph, std::span<const TaskIndex> goals, std::chrono::steady_clock::time_point deadline);

  /// Of all graphs so far.
  size_t tasksRun() const { return run_; }
  size_t tasksReused() const { return reused_; }
  /// RunResult::sections, summed over them.
  const std::map<std::string, double>& sectionSeconds() const { return section_seconds_; }

 private:
  RunResult execute(const TaskGraph& graph, std::span<const TaskIndex> goals, RunOptions options);

  Executor& executor_;
  ResultStore& store_;
  const RunOptions options_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  size_t run_ = 0, reused_ = 0;
  std::map<std::string, double> section_seconds_;
};

}  // namespace lightwell::bake
