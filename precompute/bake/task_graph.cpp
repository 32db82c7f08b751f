#include "precompute/bake/task_graph.h"

#include <stdexcept>

namespace lightwell::bake {

TaskIndex TaskGraph::add(TaskDescription description) {
  const auto index = static_cast<TaskIndex>(tasks_.size());
  if (!description.run) throw std::logic_error("task " + description.id + " has no function");
  if (!(description.cost > 0)) throw std::logic_error("task " + description.id + " needs a positive cost");
  KeyHasher hasher;
  hasher.add(version_).add(description.kind).add(description.parameters).add(uint64_t(description.inputs.size()));
  for (const TaskIndex input : description.inputs) {
    if (input >= index) throw std::logic_error("task " + description.id + " names an input that does not exist");
    hasher.add(tasks_[input].key);
  }
  if (!index_of_id_.emplace(description.id, index).second) throw std::logic_error("task id " + description.id + " is in use");
  tasks_.push_back({std::move(description.id), std::move(description.phase), hasher.finish(), std::move(description.inputs),
                    description.cost, std::move(description.run)});
  return index;
}

}  // namespace lightwell::bake
