#include "precompute/bake/task_runner.h"

#include <utility>

namespace lightwell::bake {

TaskRunner::TaskRunner(Executor& executor, ResultStore& store, RunOptions options)
    : executor_(executor), store_(store), options_(std::move(options)) {}

RunResult TaskRunner::execute(const TaskGraph& graph, std::span<const TaskIndex> goals, RunOptions options) {
  if (options.progress)
    options.progress = [this, tell = std::move(options.progress)](const Progress& of_graph) {
      Progress progress = of_graph;
      progress.tasks_done += run_ + reused_;
      progress.tasks_total += run_ + reused_;
      progress.tasks_reused += reused_;
      progress.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
      tell(progress);
    };
  RunResult result = executor_.run(graph, goals, store_, options);
  run_ += result.tasks_run;
  reused_ += result.tasks_reused;
  for (const PhaseTime& section : result.sections) section_seconds_[section.name] += section.seconds;
  return result;
}

std::vector<Blob> TaskRunner::prepare(const TaskGraph& graph, std::span<const TaskIndex> goals) {
  RunOptions options = options_;
  if (options_.progress)
    options.progress = [this](const Progress& of_graph) {
      Progress progress = of_graph;
      progress.fraction = 0;
      progress.eta_s = -1;
      options_.progress(progress);
    };
  return execute(graph, goals, std::move(options)).goals;
}

RunResult TaskRunner::run(const TaskGraph& graph, std::span<const TaskIndex> goals, std::chrono::steady_clock::time_point deadline) {
  RunOptions options = options_;
  options.deadline = deadline;
  return execute(graph, goals, std::move(options));
}

}  // namespace lightwell::bake
