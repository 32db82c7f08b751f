#include "precompute/bake/prm_tasks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/bake/bake.h"
#include "precompute/bake/probe_tasks.h"
#include "precompute/bake/stage_tasks.h"

namespace lightwell::bake {
namespace {

// Lamps that stay where they are lose the same light to rounding for ever; others come and go.
constexpr float kFixedLampsStepShare = 0.1f;

// Elements of a stage in one task: a few tenths of a second of work. Part of what names a task, never of what it computes.
constexpr uint32_t kGroupsPerTask = 32, kLightsPerTask = 8, kSidesPerTask = 2048, kBlocksPerTask = 32, kProbesPerTask = 64;

/// The clusters: all stages but the emitters' know the surfaces by them.
Parameters entryParameters(const Key& scene, const transport::PrmSettings& s, const SceneKeys& keys) {
  const transport::EntryOptions& e = s.entries;
  Parameters parameters = Parameters(scene).add(e.clusters, e.groups, e.points_per_cluster, e.points_per_group, e.denser_where_near, e.split_by_visibility, s.seed);
  return transport::mergesUnreached(s) ? parameters.add(priorKey(s.prior, keys)) : parameters;
}

/// What was chosen by hand holds for every quality and refinement. A pane is that of a group.
void applyChoices(const plan::Settings& settings, transport::PrmSettings& prm) {
  const bool panes = settings.prm_layout == plan::PrmLayout::panes;
  prm.layout = panes ? transport::PrmLayoutKind::panes : transport::PrmLayoutKind::local_bases;
  prm.estimator = settings.prm_estimator == plan::PrmEstimator::walks ? transport::PaneEstimator::walks : transport::PaneEstimator::gather;
  transport::EntryOptions& entries = prm.entries;
  uint32_t& clusters = panes ? entries.groups : entries.clusters;
  if (settings.prm_clusters) clusters = settings.prm_clusters;
  if (settings.prm_entries) (panes ? entries.points_per_group : entries.points_per_cluster) = std::max(1u, settings.prm_entries / clusters);
  entries.split_by_visibility = entries.denser_where_near = !panes;  // as many panes as asked for
  if (panes) entries.clusters = std::max(entries.clusters, entries.groups);  // clusters lie inside groups
  else entries.groups = std::min(entries.groups, entries.clusters);
}

}  // namespace

transport::LightPrior lightPrior(const plan::Settings& settings, const scene::Scene& scene) {
  using Places = transport::LightPrior::Places;
  transport::LightPrior prior;
  switch (settings.moving_lights) {
    case plan::MovingLights::ceilings: prior.places = Places::ceilings; break;
    case plan::MovingLights::sun: prior.places = Places::sun; break;
    case plan::MovingLights::lamps: prior.places = Places::lamps; break;
    case plan::MovingLights::paths: prior.places = Places::paths; break;
    case plan::MovingLights::anywhere:
    case plan::MovingLights::none: break;
  }
  for (const auto& path_m : settings.light_paths_m) {
    auto& path = prior.paths.emplace_back();
    for (const auto& point_m : path_m) {
      Vec3& point = path.emplace_back();
      for (int k = 0; k < 3; ++k) point[k] = float((point_m[size_t(k)] - scene.origin_m[k]) / scene.metres_per_unit);
    }
  }
  return prior;
}

void checkPrior(const BakeContext& context, const transport::LightPrior& prior) {
  if (!transport::samplePriorLights(context.scene(), context.atlas(), *context.tracer(), prior, 1, context.settings().seed).empty()) return;
  if (prior.places == transport::LightPrior::Places::lamps) throw UsageError("--moving-lights lamps: the scene has no lamps; --lights FILE brings some");
  if (prior.places == transport::LightPrior::Places::ceilings) throw UsageError("--moving-lights ceilings: no surface of the scene looks down, or none has room below it");
}

transport::PrmSettings prmSettings(const plan::Settings& settings, const scene::Scene& scene) {
  transport::PrmSettings prm;
  prm.seed = settings.seed;
  prm.prior = lightPrior(settings, scene);
  prm.merge_unreached = !settings.keep_all;
  switch (settings.quality) {
    case plan::Quality::draft:
      prm.entries.clusters = 4096, prm.entries.groups = 384;
      prm.cluster_rays = 64, prm.bases.rays = 128, prm.training_lights = 192, prm.emitter_samples = 16;
      prm.bases.rank_error = 0.2f, prm.bases.wavelet_step = 0.03f, prm.probe_rays = 1024;
      break;
    case plan::Quality::preview:
      prm.entries.clusters = 8192, prm.entries.groups = 768;
      prm.cluster_rays = 128, prm.bases.rays = 256, prm.training_lights = 288, prm.emitter_samples = 32;
      prm.bases.rank_error = 0.15f, prm.bases.wavelet_step = 0.0225f, prm.probe_rays = 2048;
      break;
    case plan::Quality::production:  // the estimator's defaults, which are made for local bases
      if (settings.prm_layout == plan::PrmLayout::panes) prm.entries.groups = 1024, prm.cluster_rays = 256, prm.bases.rays = 768;
      break;
  }
  if (settings.moving_lights == plan::MovingLights::lamps) prm.bases.wavelet_step *= kFixedLampsStepShare;
  const float factor = std::exp2(float(settings.refinement));
  prm.bases.rank_error /= factor;
  prm.bases.wavelet_step /= factor;
  if (settings.refinement > 0) {
    const uint32_t more = 1u << settings.refinement;
    prm.cluster_rays *= more, prm.bases.rays *= more, prm.probe_rays *= more;
    prm.entries.clusters *= more, prm.training_lights *= more;
    prm.walks_per_entry *= more;
  } else {
    prm.bases.most_rank = std::max(1u, prm.bases.most_rank >> -settings.refinement);
    if (settings.prm_layout == plan::PrmLayout::panes) prm.entries.groups = std::max(1u, prm.entries.groups >> -settings.refinement);
  }
  if (settings.prm_layout == plan::PrmLayout::local_bases) prm.probes = probePoints(settings, scene);
  applyChoices(settings, prm);
  return prm;
}

Key priorKey(const transport::LightPrior& prior, const SceneKeys& keys) {
  KeyHasher hasher;
  hasher.add(prior.places);
  if (prior.places == transport::LightPrior::Places::lamps) hasher.add(keys.lights);
  for (const auto& path : prior.paths) hasher.addArray(path.data(), path.size());
  return hasher.finish();
}

std::shared_ptr<const transport::PrmBaker> makePrmBaker(const BakeContext& context, const transport::PrmSettings& settings, TaskRunner& tasks) {
  TaskGraph graph(productVersion());
  const TaskIndex entries =
      graph.add({"prm/entries", "entries", "prm/entries", entryParameters(context.keys().geometry, settings, context.keys()).text(), {},
                 double(settings.entries.clusters), [&](const TaskInputs& in) {
                   return transport::toBytes(transport::makePrmEntries(context.scene(), context.atlas(), *context.tracer(), settings, context.threads(), &in.cancel));
                 }});
  const auto results = tasks.prepare(graph, std::array{entries});
  return std::make_shared<transport::PrmBaker>(context.scene(), context.atlas(), *context.tracer(), settings,
                                               transport::readEntries(*results[0]));
}

PrmTasks addPrmTasks(TaskGraph& graph, const BakeContext& context, const transport::PrmSettings& settings,
                     std::shared_ptr<const transport::PrmBaker> baker) {
  PrmTasks tasks{baker, {}, {}, {}};
  const SceneKeys& keys = context.keys();
  const transport::LocalBasesOptions& bases = settings.bases;
  const double entries = settings.entries.clusters * double(settings.entries.points_per_cluster);
  const auto bounces = addRange(graph, "prm", "bounces", entryParameters(keys.reflection, settings, keys).add(settings.cluster_rays), baker->groupCount(),
                                kGroupsPerTask, settings.cluster_rays, {},
                                [baker](uint32_t first, uint32_t end, const TaskInputs&) { return baker->oneBounce(first, end); });
  // A training light does not depend on their number: more of them are made from those that there are.
  const auto training = addRange(graph, "prm", "training", entryParameters(keys.geometry, settings, keys).add(priorKey(settings.prior, keys)), baker->trainingLightCount(), kLightsPerTask, entries, {},
                                 [baker](uint32_t first, uint32_t end, const TaskInputs&) { return baker->trainingDirect(first, end); });
  if (baker->hasEmitters())
    tasks.emitter = addRange(graph, "prm", "emitters", Parameters(keys.emission).add(settings.emitter_samples, bases.rays, settings.seed), baker->sideCount(),
                             kSidesPerTask, 2.0 * settings.emitter_samples, {},
                             [baker](uint32_t first, uint32_t end, const TaskInputs&) { return baker->emitterDirect(first, end); });

  std::vector<TaskIndex> solve_inputs = bounces;
  solve_inputs.insert(solve_inputs.end(), training.begin(), training.end());
  solve_inputs.insert(solve_inputs.end(), tasks.emitter.begin(), tasks.emitter.end());
  const double groups = baker->groupCount();
  const TaskIndex solve = graph.add(
      {"prm/solve", "solve", "prm/solve", entryParameters(keys.geometry, settings, keys).text(), solve_inputs,
       std::max(1.0, groups * groups * groups * 1e-3), [baker, bounces = bounces.size(), training = training.size()](const TaskInputs& in) {
         const auto views = viewsOf(in.inputs);
         const std::span<const ByteView> all(views);
         return baker->solve(all.first(bounces), all.subspan(bounces, training), all.subspan(bounces + training));
       }});
  const Parameters fit = entryParameters(keys.reflection, settings, keys)
                             .add(settings.layout, settings.estimator, settings.walks_per_entry, bases.block_texels, bases.least_texels, bases.most_rank,
                                  bases.rank_error, bases.wavelet_step, bases.rays);
  tasks.blocks = addRange(graph, "prm", "fit", fit, baker->blockCount(), kBlocksPerTask, 4.0 * bases.block_texels * bases.rays, {solve},
                          [baker](uint32_t first, uint32_t end, const TaskInputs& in) { return baker->fit(first, end, in.inputs[0]); });
  if (baker->probeCount() > 0) {
    Parameters parameters = Parameters(fit).add(settings.probe_rays);
    for (const Vec3& point : settings.probes) parameters.add(point.x, point.y, point.z);
    tasks.probes = addRange(graph, "prm", "probes", parameters, baker->probeCount(), kProbesPerTask, 1.0 * settings.probe_rays, {solve},
                            [baker](uint32_t first, uint32_t end, const TaskInputs& in) { return baker->fitProbes(first, end, in.inputs[0]); });
  }
  return tasks;
}

transport::PrmResult assemblePrm(const PrmTasks& tasks, std::span<const Blob> blocks, std::span<const Blob> emitter, std::span<const Blob> probes) {
  transport::PrmResult prm = tasks.baker->assemble(viewsOf(blocks), viewsOf(emitter));
  if (!probes.empty()) prm.probes = tasks.baker->assembleProbes(viewsOf(probes));
  return prm;
}

}  // namespace lightwell::bake
