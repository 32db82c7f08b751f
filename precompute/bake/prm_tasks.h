// The stages of a PRM bake as tasks of the graph.
#pragma once
#include <memory>

#include "precompute/bake/context.h"
#include "precompute/transport/prm/bake_prm.h"

namespace lightwell::bake {

/// Where the settings say that lights move.
transport::LightPrior lightPrior(const plan::Settings& settings, const scene::Scene& scene);
/// Everything that samples from it depend on besides the surfaces.
Key priorKey(const transport::LightPrior& prior, const SceneKeys& keys);
/// Throws UsageError when no light of it fits into the scene.
void checkPrior(const BakeContext& context, const transport::LightPrior& prior);

/// The estimator's settings for a bake's settings.
transport::PrmSettings prmSettings(const plan::Settings& settings, const scene::Scene& scene);

/// With the clusters of entry points as a task of their own, run by `tasks`: how many of them there are says which other tasks there are.
/// `context` must have a tracer and outlive the baker.
std::shared_ptr<const transport::PrmBaker> makePrmBaker(const BakeContext& context, const transport::PrmSettings& settings, TaskRunner& tasks);

/// What the section "prm" is assembled from. Outlives the graph's run.
struct PrmTasks {
  std::shared_ptr<const transport::PrmBaker> baker;
  std::vector<TaskIndex> blocks, emitter, probes;  // outputs of fit, of emitterDirect and of fitProbes, in range order
};

/// Adds the tasks up to the fitted blocks. `context` must have a tracer and outlive the graph; `baker` was made with `settings`.
PrmTasks addPrmTasks(TaskGraph& graph, const BakeContext& context, const transport::PrmSettings& settings,
                     std::shared_ptr<const transport::PrmBaker> baker);

/// Joins their outputs. Every covered texel has its own value, buried ones too: what they show is the atlas's matter.
transport::PrmResult assemblePrm(const PrmTasks& tasks, std::span<const Blob> blocks, std::span<const Blob> emitter, std::span<const Blob> probes);

}  // namespace lightwell::bake
