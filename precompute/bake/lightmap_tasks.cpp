#include "precompute/bake/lightmap_tasks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/bake/bake.h"
#include "precompute/bake/radiosity_tasks.h"

namespace lightwell::bake {
namespace {

// Elements of a stage in one task: a few tenths of a second of work. Part of what names a task, never of what it computes.
constexpr uint32_t kSidesPerTask = 2048, kPatchesPerTask = 512, kSlotsPerTask = 1024, kMeasuredPerTask = 64;
constexpr double kRaysPerMeasured = 2000;  // about

/// All that shines.
Parameters lightParameters(const BakeContext& context, const transport::LightmapSettings& s) {
  return Parameters(context.keys().geometry).add(context.keys().emission).add(context.keys().lights).add(context.skyKey()).add(s.direct.samples, s.directional, s.seed);
}

}  // namespace

transport::LightmapSettings lightmapSettings(const plan::Settings& settings) {
  transport::LightmapSettings lightmap;
  lightmap.seed = settings.seed;
  lightmap.directional = settings.directional;
  transport::DirectOptions& direct = lightmap.direct;
  switch (settings.quality) {
    case plan::Quality::draft:
      direct.most_samples = 64, direct.error = 0.06f, direct.soft_samples = 16;
      lightmap.patches.most = 2000, lightmap.cache_rays = 64, lightmap.first_gather_rays = 8, lightmap.gather_rays = 16;
      break;
    case plan::Quality::preview:
      direct.most_samples = 256, direct.error = 0.03f, direct.soft_samples = 48;
      lightmap.patches.most = 4000, lightmap.cache_rays = 128, lightmap.first_gather_rays = 16, lightmap.gather_rays = 48;
      break;
    case plan::Quality::production: break;  // the estimator's defaults
  }
  // A step halves the error: four times the samples.
  const double factor = std::exp2(2.0 * settings.refinement);
  const auto scaled = [&](uint32_t value, uint32_t least, uint32_t most) { return uint32_t(std::clamp(value * factor, double(least), double(most))); };
  direct.most_samples = scaled(direct.most_samples, direct.samples, 1u << 16);
  direct.error = float(direct.error / std::sqrt(factor));
  direct.soft_samples = scaled(direct.soft_samples, 4, 1u << 16);
  lightmap.gather_rays = scaled(lightmap.gather_rays, 4, 1u << 16) & ~1u;
  lightmap.first_gather_rays = scaled(lightmap.first_gather_rays, 4, 1u << 16) & ~1u;
  lightmap.cache_rays = scaled(lightmap.cache_rays, 16, 4096);
  lightmap.patches.most = scaled(lightmap.patches.most, 64, 64000);
  return lightmap;
}

std::shared_ptr<const transport::LightmapBaker> makeLightmapBaker(const BakeContext& context, const transport::LightmapSettings& settings, TaskRunner& tasks) {
  TaskGraph graph(productVersion());
  const TaskIndex patches = graph.add({"lightmap/patches", "patches", "lightmap/patches", patchParameters(context, settings.patches, settings.seed).text(), {},
                                       double(context.atlas().slots.size()), [&](const TaskInputs& in) {
                                         return transport::makeLightmapPatchBytes(context.scene(), context.atlas(), *context.tracer(), settings, context.threads(),
                                                                                  &in.cancel);
                                       }});
  const auto results = tasks.prepare(graph, std::array{patches});
  return std::make_shared<transport::LightmapBaker>(context.scene(), context.atlas(), *context.tracer(), context.scene().lights, context.skyLight(), settings,
                                                    *results[0]);
}

LightmapTasks addLightmapTasks(TaskGraph& graph, const BakeContext& context, const transport::LightmapSettings& settings,
                               std::shared_ptr<const transport::LightmapBaker> baker, bool measure) {
  const transport::DirectOptions& d = settings.direct;
  LightmapTasks tasks;
  const auto first = addRange(graph, "lightmap", "first light", lightParameters(context, settings), baker->sideCount(), kSidesPerTask, d.samples, {},
                              [baker](uint32_t begin, uint32_t end, const TaskInputs& in) { return baker->firstLight(begin, end, in.cancel); });
  tasks.direct = addRange(graph, "lightmap", "direct light", lightParameters(context, settings).add(d.most_samples, d.edge_samples, d.error, d.soft_samples), baker->sideCount(),
                          kSidesPerTask, 4 * d.samples, first, [baker](uint32_t begin, uint32_t end, const TaskInputs& in) {
                            return baker->directLight(begin, end, viewsOf(in.inputs), in.cancel);
                          });
  const auto rows = addRange(graph, "lightmap", "patch rays", patchParameters(context, settings.patches, settings.seed).add(settings.cache_rays), baker->patchCount(), kPatchesPerTask,
                             settings.cache_rays, {}, [baker](uint32_t begin, uint32_t end, const TaskInputs&) { return baker->rows(begin, end); });
  std::vector<TaskIndex> inputs = tasks.direct;
  inputs.insert(inputs.end(), rows.begin(), rows.end());
  const Parameters reflection = patchParameters(context, settings.patches, settings.seed).add(context.keys().reflection).add(settings.cache_rays);
  const TaskIndex radiosity = graph.add({"lightmap/radiosity", "radiosity", "lightmap/radiosity", reflection.text(), inputs, 16.0 * baker->patchCount(),
                                         [baker, count = tasks.direct.size()](const TaskInputs& in) {
                                           const auto views = viewsOf(in.inputs);
                                           return baker->radiosity(std::span(views).first(count), std::span(views).subspan(count), in.cancel);
                                         }});
  const auto first_gathered = addRange(graph, "lightmap", "first gather", Parameters(reflection).add(settings.first_gather_rays), baker->slotCount(), kSlotsPerTask,
                                       settings.first_gather_rays, {radiosity},
                                       [baker](uint32_t begin, uint32_t end, const TaskInputs& in) { return baker->firstGather(begin, end, *in.inputs[0], in.cancel); });
  inputs = tasks.direct;
  inputs.push_back(radiosity);
  inputs.insert(inputs.end(), first_gathered.begin(), first_gathered.end());
  const TaskIndex refined = graph.add({"lightmap/refine", "refine", "lightmap/refine", Parameters(reflection).add(settings.first_gather_rays).text(), inputs,
                                       16.0 * baker->slotCount(), [baker, count = tasks.direct.size(), threads = context.threads()](const TaskInputs& in) {
                                         const auto views = viewsOf(in.inputs);
                                         return baker->refine(std::span(views).first(count), views[count], std::span(views).subspan(count + 1), threads, in.cancel);
                                       }});
  tasks.gathered = addRange(graph, "lightmap", "gather", Parameters(reflection).add(settings.gather_rays, settings.directional), baker->slotCount(), kSlotsPerTask,
                            settings.gather_rays, {refined},
                            [baker](uint32_t begin, uint32_t end, const TaskInputs& in) { return baker->gather(begin, end, *in.inputs[0], in.cancel); });
  if (measure) {
    tasks.measured = addRange(graph, "lightmap", "measure", Parameters(context.keys().reflection).add(lightParameters(context, settings)), baker->referenceCount(),
                              kMeasuredPerTask, kRaysPerMeasured, {refined},
                              [baker](uint32_t begin, uint32_t end, const TaskInputs& in) { return baker->references(begin, end, *in.inputs[0], in.cancel); });
    tasks.measured.insert(tasks.measured.begin(), refined);
  }
  return tasks;
}

}  // namespace lightwell::bake
