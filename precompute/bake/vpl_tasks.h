// Virtual lights as tasks of the graph: light paths, then their clusters.
#pragma once
#include <memory>

#include "precompute/bake/context.h"
#include "precompute/bake/task_graph.h"
#include "precompute/transport/many_lights/virtual_lights.h"

namespace lightwell::bake {

struct VplSettings {
  transport::LightPathOptions paths;
  transport::ClusterOptions clusters;
};
/// For a bake's settings.
VplSettings vplSettings(const plan::Settings& settings);

/// The task that yields readVplResult's bytes. `context` must have a tracer and outlive the graph.
TaskIndex addVplTasks(TaskGraph& graph, const BakeContext& context, const VplSettings& settings);

struct VplResult {
  uint64_t points = 0;  // that the lights stand for
  std::vector<transport::VirtualLight> lights;
};
/// Throws std::runtime_error for other bytes.
VplResult readVplResult(ByteView bytes);

}  // namespace lightwell::bake
