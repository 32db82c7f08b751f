// Virtual lights as tasks of the graph: light paths, then their clusters.
#pragma once
#include <memory>

#include "precompute/bake/context.h"
#include "precompute/bake/measured_error.h"
#include "precompute/bake/task_graph.h"
#include "precompute/transport/many_lights/virtual_lights.h"

namespace lightwell::bake {

struct VplSettings {
  transport::LightPathOptions paths;
  transport::ClusterOptions clusters;
};
/// For a bake's settings.
VplSettings vplSettings(const plan::Settings& settings);

struct VplTasks {
  TaskIndex lights = 0;                // yields readVplResult's bytes
  std::vector<TaskIndex> references;   // what its error is measured with: path-traced light at a sample of texels,
  std::vector<TaskIndex> irradiance;   // and what the lights give to the same; or none
};
/// `context` must have a tracer and outlive the graph. `measure`: the error is wanted.
VplTasks addVplTasks(TaskGraph& graph, const BakeContext& context, const VplSettings& settings, bool measure);

struct VplResult {
  uint64_t points = 0;  // that the lights stand for
  std::vector<transport::VirtualLight> lights;
};
/// Throws std::runtime_error for other bytes.
VplResult readVplResult(ByteView bytes);

/// The error of the light that virtual lights hold: emitters' own and all that was reflected. The results of the measuring tasks, in their order; a few texels are traced again. Throws Cancelled.
MeasuredError measureVpl(const BakeContext& context, const VplSettings& settings, std::span<const Blob> references, std::span<const Blob> irradiance, const CancelFlag& cancel);

}  // namespace lightwell::bake
