// The stages of baking probes as tasks of the graph.
#pragma once
#include "precompute/bake/radiosity_tasks.h"
#include "precompute/transport/radiosity/bake_probes.h"

namespace lightwell::bake {

/// The points that were asked for, in internal units.
std::vector<Vec3> probePoints(const plan::Settings& settings, const scene::Scene& scene);

/// The estimator's settings for a bake's settings.
transport::ProbeSettings probeSettings(const plan::Settings& settings, const scene::Scene& scene);

/// Probes and what their tasks need to know of them. `context` and `radiosity` must outlive it.
struct ProbesToBake {
  std::shared_ptr<const transport::RadiosityBaker> radiosity;
  transport::ProbeSettings settings;
  std::shared_ptr<const transport::ProbeBaker> baker;
};
/// With the places as a task of their own, run by `tasks`: how many probes there are says which other tasks there are.
ProbesToBake makeProbeBaker(const BakeContext& context, const plan::Settings& settings, std::shared_ptr<const transport::RadiosityBaker> radiosity,
                            TaskRunner& tasks);

/// What the section "probes" is assembled from: the outputs of links, in range order. `radiosity` are the tasks of the same graph.
std::vector<TaskIndex> addProbeTasks(TaskGraph& graph, const BakeContext& context, const ProbesToBake& probes, const transport::RadiositySettings& radiosity_settings,
                                     const RadiosityTasks& radiosity);

}  // namespace lightwell::bake
