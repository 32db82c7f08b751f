// The stages of the atlas that are worth keeping, as tasks: they are run while the context is made.
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/bake/scene_keys.h"
#include "precompute/bake/task_runner.h"
#include "precompute/trace/tracer.h"

namespace lightwell::bake {

/// Charts of objects as tasks: one that has not moved nor changed its shape keeps its charts. `tasks` must outlive the source.
atlas::ChartSource chartTasks(TaskRunner& tasks);

/// atlas::validSlots of all slots as tasks.
std::vector<uint8_t> validSlotTasks(TaskRunner& tasks, const SceneKeys& keys, const atlas::Atlas& atlas, const scene::Scene& scene,
                                    const trace::Tracer& tracer, uint64_t seed);

}  // namespace lightwell::bake
