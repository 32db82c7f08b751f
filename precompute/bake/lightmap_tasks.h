// The stages of a light map as tasks of the graph.
#pragma once
#include <memory>

#include "precompute/bake/context.h"
#include "precompute/bake/task_graph.h"
#include "precompute/transport/lightmap/bake_lightmap.h"

namespace lightwell::bake {

/// The estimator's settings for a bake's settings.
transport::LightmapSettings lightmapSettings(const plan::Settings& settings);

/// With the patches as a task of their own, run by `tasks`. `context` must have a tracer and outlive the baker.
std::shared_ptr<const transport::LightmapBaker> makeLightmapBaker(const BakeContext& context, const transport::LightmapSettings& settings, TaskRunner& tasks);

/// What the section "lightmap" is assembled from, in range order.
struct LightmapTasks {
  std::vector<TaskIndex> direct, gathered;
  std::vector<TaskIndex> measured;  // what its error is measured with: of the refined radiosity, then of the references; or none
};
/// `baker` was made with `settings`; `measure`: the error is wanted.
LightmapTasks addLightmapTasks(TaskGraph& graph, const BakeContext& context, const transport::LightmapSettings& settings,
                               std::shared_ptr<const transport::LightmapBaker> baker, bool measure);

}  // namespace lightwell::bake
