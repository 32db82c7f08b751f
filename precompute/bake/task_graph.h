// A bake as a graph of pure tasks.
//
// A task's bytes are a function of its kind, its parameters, its inputs' bytes and the product's version, and of nothing else: not of
// the thread, the process, the order or the clock. Its key is the hash of exactly those. Progress, cancel, resume, incremental bakes, a
// shared cache and other executors (worker processes, a cluster) follow from that one property.
//
// Heavy immutable inputs (scene, atlas, tracer) are not task results: each process derives them once from the scene's bytes and the
// settings (BakeContext), and a hash of what a task reads of them goes into its parameters (scene_keys.h). So (scene bytes, settings, task id) names a
// task for any process: building the same graph again yields the same ids, keys and functions.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "precompute/bake/key.h"
#include "precompute/core/bytes.h"
#include "precompute/core/diagnostics.h"

namespace lightwell::bake {

/// A task's result; immutable and shared between the store and the tasks that read it.
using Blob = std::shared_ptr<const Bytes>;
using TaskIndex = uint32_t;

/// What a running task is given. `inputs` are in the order of Task::inputs.
struct TaskInputs {
  std::span<const Blob> inputs;
  const CancelFlag& cancel;  // long tasks call cancel.check() at least every few hundred milliseconds
};

struct TaskDescription {
  std::string id;          // unique within the graph and stable between runs: "prm/gather/12"
  std::string phase;       // for progress and timing: "gather"
  std::string kind;        // which function it is; change it when the function's meaning changes within a version
  std::string parameters;  // everything else that the bytes depend on: settings that matter to it, ranges, hashes of shared inputs
  std::vector<TaskIndex> inputs;  // tasks added before
  double cost = 1;         // expected work, in any unit that is common to a phase; > 0
  std::function<Bytes(const TaskInputs&)> run;
};

struct Task {
  std::string id, phase;
  Key key;
  std::vector<TaskIndex> inputs;
  double cost;
  std::function<Bytes(const TaskInputs&)> run;
};

/// Acyclic by construction: a task can only name inputs that were added before it.
class TaskGraph {
 public:
  /// `version` enters every key, so that another version of the product never reuses these results.
  explicit TaskGraph(std::string_view version) : version_(version) {}

  /// Throws std::logic_error for an id in use, an unknown input, a cost that is not positive or a missing function.
  TaskIndex add(TaskDescription description);

  size_t size() const { return tasks_.size(); }
  const Task& task(TaskIndex index) const { return tasks_.at(index); }
  /// The index of an id; throws std::out_of_range when there is none.
  TaskIndex find(const std::string& id) const { return index_of_id_.at(id); }

 private:
  std::string version_;
  std::vector<Task> tasks_;
  std::map<std::string, TaskIndex> index_of_id_;
};

}  // namespace lightwell::bake
