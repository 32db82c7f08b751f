// The stages of a radiosity bake as tasks of the graph.
#pragma once
#include <memory>

#include "precompute/bake/context.h"
#include "precompute/bake/stage_tasks.h"
#include "precompute/transport/radiosity/bake_radiosity.h"

namespace lightwell::bake {

/// The estimator's settings for a bake's settings.
transport::RadiositySettings radiositySettings(const plan::Settings& settings);

/// What every task that reads patches depends on.
Parameters patchParameters(const BakeContext& context, const transport::PatchOptions& options, uint64_t seed);

/// With the patches as a task of their own, run by `tasks`: how many of them there are says which other tasks there are. `context` must have a
/// tracer and outlive the baker.
std::shared_ptr<const transport::RadiosityBaker> makeRadiosityBaker(const BakeContext& context, const transport::RadiositySettings& settings,
                                                                    TaskRunner& tasks);

struct RadiosityTasks {
  std::vector<TaskIndex> links;  // what the section "radiosity" is assembled from, in range order
  TaskIndex train = 0;
};
/// `baker` was made with `settings`.
RadiosityTasks addRadiosityTasks(TaskGraph& graph, const BakeContext& context, const transport::RadiositySettings& settings,
                                         std::shared_ptr<const transport::RadiosityBaker> baker);

}  // namespace lightwell::bake
