// The stages of a radiosity bake as tasks of the graph.
#pragma once
#include <memory>

#include "precompute/bake/context.h"
#include "precompute/transport/radiosity/bake_radiosity.h"

namespace lightwell::bake {

/// The estimator's settings for a bake's settings.
transport::RadiositySettings radiositySettings(const plan::Settings& settings);

/// With the patches as a task of their own, run by `tasks`: how many of them there are says which other tasks there are. `context` must have a
/// tracer and outlive the baker.
std::shared_ptr<const transport::RadiosityBaker> makeRadiosityBaker(const BakeContext& context, const transport::RadiositySettings& settings,
                                                                    TaskRunner& tasks);

/// What the section "radiosity" is assembled from: the outputs of links, in range order. `baker` was made with `settings`.
std::vector<TaskIndex> addRadiosityTasks(TaskGraph& graph, const BakeContext& context, const transport::RadiositySettings& settings,
                                         std::shared_ptr<const transport::RadiosityBaker> baker);

}  // namespace lightwell::bake
