#include "precompute/bake/executor.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <map>
#include <queue>
#include <thread>
#include <utility>

#include "precompute/core/parallel.h"

namespace lightwell::bake {
namespace {

using Clock = std::chrono::steady_clock;
double secondsBetween(Clock::time_point a, Clock::time_point b) { return std::chrono::duration<double>(b - a).count(); }

/// The section that a task works for; empty for a task that measures.
std::string sectionOf(const Task& task) { return task.phase.starts_with("measure") ? std::string() : task.id.substr(0, task.id.find('/')); }

/// Times of the phases, and from them the expected time to the end.
class Stopwatch {
 public:
  explicit Stopwatch(const TaskGraph& graph) {
    for (TaskIndex i = 0; i < graph.size(); ++i) {
      if (phases_.try_emplace(graph.task(i).phase).second) order_.push_back(graph.task(i).phase);
      if (const std::string section = sectionOf(graph.task(i)); sections_.try_emplace(section).second) section_order_.push_back(section);
    }
  }
  void expect(const Task& task) { phases_[task.phase].cost_open += task.cost; }
  void start(const Task& task) {
    advance();
    ++phases_[task.phase].running;
    ++sections_[sectionOf(task)].running;
    ++running_;
    last_phase_ = task.phase;
  }
  void finish(const Task& task, double task_seconds) {
    advance();
    Phase& phase = phases_[task.phase];
    --phase.running;
    --sections_[sectionOf(task)].running;
    --running_;
    phase.ran = true;
    phase.cost_open -= task.cost;
    phase.cost_done += task.cost;
    phase.task_seconds += task_seconds;
  }
  void report(Progress& progress, int threads) const {
    double cost_done = 0, task_seconds = 0, work_done_s = 0, work_open_s = 0;
    for (const auto& [name, phase] : phases_) cost_done += phase.cost_done, task_seconds += phase.task_seconds;
    const double mean_rate = cost_done > 0 ? task_seconds / cost_done : 1;
    for (const auto& [name, phase] : phases_) {
      const double rate = phase.cost_done > 0 ? phase.task_seconds / phase.cost_done : mean_rate;
      work_done_s += phase.cost_done * rate;
      work_open_s += std::max(phase.cost_open, 0.0) * rate;
    }
    progress.phase = last_phase_;
    progress.elapsed_s = secondsBetween(begin_, Clock::now());
    progress.fraction = work_done_s + work_open_s > 0 ? work_done_s / (work_done_s + work_open_s) : 1;
    progress.eta_s = cost_done > 0 && progress.elapsed_s > 0.5 ? work_open_s / threads : -1;
  }
  std::vector<PhaseTime> times() const {
    std::vector<PhaseTime> result;
    for (const auto& name : order_)
      if (const Phase& phase = phases_.at(name); phase.ran) result.push_back({name, phase.wall_seconds});
    return result;
  }
  std::vector<PhaseTime> sectionTimes() const {
    std::vector<PhaseTime> result;
    for (const auto& name : section_order_)
      if (const double seconds = sections_.at(name).wall_seconds; !name.empty() && seconds > 0) result.push_back({name, seconds});
    return result;
  }

 private:
  struct Phase {
    double cost_open = 0, cost_done = 0, task_seconds = 0, wall_seconds = 0;
    int running = 0;
    bool ran = false;
  };
  void advance() {
    const auto now = Clock::now();
    if (running_) {
      const double each = secondsBetween(last_, now) / running_;
      for (auto& [name, phase] : phases_) phase.wall_seconds += each * phase.running;
      for (auto& [name, section] : sections_) section.wall_seconds += each * section.running;
    }
    last_ = now;
  }
  struct Section {
    double wall_seconds = 0;
    int running = 0;
  };
  std::map<std::string, Phase> phases_;
  std::map<std::string, Section> sections_;
  std::vector<std::string> order_, section_order_;
  std::string last_phase_;
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
  int running_ = 0;
};

/// One run: first the store is asked, from the goals down, then the tasks that are missing run.
class Run {
 public:
  Run(const TaskGraph& graph, ResultStore& store, const RunOptions& options, int threads)
      : graph_(graph), store_(store), options_(options), threads_(threads), states_(graph.size()), stopwatch_(graph) {}

  RunResult operator()(std::span<const TaskIndex> goals) {
    discover(goals);
    std::vector<std::thread> pool;
    if (!finished())
      for (int i = 0; i < threads_; ++i) pool.emplace_back([this] { work(); });
    supervise();
    for (auto& thread : pool) thread.join();
    if (error_) std::rethrow_exception(error_);
    if (stop_ && !cancelled()) throw DeadlinePassed();
    if (stop_) throw Cancelled();
    RunResult result;
    for (const TaskIndex goal : goals) result.goals.push_back(states_[goal].result);
    result.phases = stopwatch_.times();
    result.sections = stopwatch_.sectionTimes();
    result.tasks_run = done_ - reused_;
    result.tasks_reused = reused_;
    return result;
  }

 private:
  struct State {
    bool demanded = false;
    uint32_t missing_inputs = 0;
    uint32_t readers = 0;            // those that still have to read the result: tasks, and the caller for a goal
    std::vector<TaskIndex> waiting;  // tasks to tell when the result is there
    Blob result;
  };

  /// Before any task runs, so that no result can be dropped while a reader of it is still unknown.
  void discover(std::span<const TaskIndex> goals) {
    std::vector<TaskIndex> demanded;
    const auto demand = [&](TaskIndex index) {
      ++states_[index].readers;
      if (!std::exchange(states_[index].demanded, true)) demanded.push_back(index);
    };
    for (const TaskIndex goal : goals) demand(goal);
    for (size_t i = 0; i < demanded.size() && !stop_; ++i) {
      const TaskIndex index = demanded[i];
      if ((states_[index].result = store_.get(graph_.task(index).key))) {
        ++reused_, ++done_;
      } else {
        stopwatch_.expect(graph_.task(index));
        for (const TaskIndex input : graph_.task(index).inputs) demand(input);
      }
      stop_ = mustStop();
    }
    total_ = demanded.size();
    for (const TaskIndex index : demanded) {
      if (states_[index].result) continue;
      for (const TaskIndex input : graph_.task(index).inputs) {
        if (states_[input].result) continue;
        ++states_[index].missing_inputs;
        states_[input].waiting.push_back(index);
      }
      if (states_[index].missing_inputs == 0) ready_.push(index);
    }
  }

  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [&] { return finished() || !ready_.empty(); });
      if (finished()) return;
      const TaskIndex index = ready_.top();
      ready_.pop();
      execute(index, lock);
      changed_.notify_all();
    }
  }

  void execute(TaskIndex index, std::unique_lock<std::mutex>& lock) {
    static const CancelFlag never;
    const Task& task = graph_.task(index);
    std::vector<Blob> inputs;
    for (const TaskIndex input : task.inputs) inputs.push_back(states_[input].result);
    stopwatch_.start(task);
    lock.unlock();
    const auto begin = Clock::now();
    Blob result;
    std::exception_ptr error;
    try {
      result = std::make_shared<const Bytes>(task.run({inputs, options_.cancel ? *options_.cancel : never}));
      store_.put(task.key, result);
    } catch (...) {
      error = std::current_exception();
    }
    inputs.clear();
    const double seconds = secondsBetween(begin, Clock::now());
    lock.lock();
    stopwatch_.finish(task, seconds);
    if (error) return fail(index, error);
    for (const TaskIndex input : task.inputs)
      if (--states_[input].readers == 0) states_[input].result.reset();
    states_[index].result = std::move(result);
    ++done_;
    for (const TaskIndex reader : states_[index].waiting)
      if (--states_[reader].missing_inputs == 0) ready_.push(reader);
  }

  void fail(TaskIndex index, std::exception_ptr error) {
    stop_ = true;
    if (cancelled() || (error_ && error_task_ < index)) return;
    error_ = error;
    error_task_ = index;
  }

  bool cancelled() const { return options_.cancel && options_.cancel->cancelled(); }
  bool mustStop() const { return cancelled() || Clock::now() >= options_.deadline; }
  bool finished() const { return stop_ || done_ == total_; }

  /// Reports progress and watches the cancel flag while the threads work.
  void supervise() {
    constexpr auto kPoll = std::chrono::milliseconds(50), kReport = std::chrono::milliseconds(250);
    auto next_report = Clock::now();
    std::unique_lock lock(mutex_);
    while (!finished()) {
      changed_.wait_for(lock, kPoll, [&] { return finished(); });
      if (mustStop()) stop_ = true;
      if (Clock::now() < next_report) continue;
      next_report = Clock::now() + kReport;
      report(lock);
    }
    if (!stop_) report(lock);
    changed_.notify_all();
  }
  void report(std::unique_lock<std::mutex>& lock) {
    if (!options_.progress) return;
    Progress progress;
    progress.tasks_done = done_, progress.tasks_total = total_, progress.tasks_reused = reused_;
    stopwatch_.report(progress, threads_);
    lock.unlock();
    options_.progress(progress);
    lock.lock();
  }

  const TaskGraph& graph_;
  ResultStore& store_;
  const RunOptions& options_;
  const int threads_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<State> states_;
  std::priority_queue<TaskIndex, std::vector<TaskIndex>, std::greater<>> ready_;  // the earliest in the graph first
  Stopwatch stopwatch_;
  size_t done_ = 0, total_ = 0, reused_ = 0;
  bool stop_ = false;
  std::exception_ptr error_;
  TaskIndex error_task_ = 0;
};

}  // namespace

ThreadExecutor::ThreadExecutor(int threads) : threads_(threads > 0 ? threads : hardwareThreads()) {}

RunResult ThreadExecutor::run(const TaskGraph& graph, std::span<const TaskIndex> goals, ResultStore& store, const RunOptions& options) {
  return Run(graph, store, options, threads_)(goals);
}

}  // namespace lightwell::bake
