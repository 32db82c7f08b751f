#include "precompute/bake/radiosity_tasks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/bake/bake.h"

namespace lightwell::bake {
namespace {

// Elements of a stage in one task: a few tenths of a second of work. Part of what names a task, never of what it computes.
constexpr uint32_t kPatchesPerTask = 256, kLightsPerTask = 8, kRowsPerTask = 1024;

}  // namespace

transport::RadiositySettings radiositySettings(const plan::Settings& settings) {
  transport::RadiositySettings radiosity;
  radiosity.seed = settings.seed;
  switch (settings.quality) {
    case plan::Quality::draft:
      radiosity.rays = 256, radiosity.training_lights = 16, radiosity.patches.most = 4000, radiosity.patches.coarsest = 4;
      radiosity.links.link_error = 0.06f, radiosity.links.uneven = 0.003f;
      break;
    case plan::Quality::preview:
      radiosity.rays = 768, radiosity.training_lights = 32, radiosity.patches.most = 8000, radiosity.patches.coarsest = 4;
      radiosity.links.link_error = 0.04f, radiosity.links.uneven = 0.002f;
      break;
    case plan::Quality::production: break;  // the estimator's defaults
  }
  const float factor = std::exp2(float(settings.refinement));
  radiosity.links.link_error /= factor;
  radiosity.links.uneven /= factor;
  radiosity.patches.most = std::max(64u, uint32_t(float(radiosity.patches.most) * factor));
  if (settings.refinement > 0) radiosity.rays *= 1u << settings.refinement;
  if (settings.radiosity_density > 0) {
    // One size of square: as dense as asked for.
    const auto texels = uint32_t(std::exp2(std::round(-std::log2(settings.radiosity_density))));
    radiosity.patches.finest = radiosity.patches.coarsest = texels;
  }
  return radiosity;
}

// Every stage knows the surfaces by their patches, which do not reach over from one material to the next.
Parameters patchParameters(const BakeContext& context, const transport::PatchOptions& p, uint64_t seed) {
  KeyHasher materials;
  materials.addArray(context.scene().mesh.triangle_material.data(), context.scene().mesh.triangle_material.size());
  return Parameters(context.keys().geometry).add(materials.finish()).add(context.keys().portals).add(p.coarsest, p.finest, p.near_share, p.most, seed);
}

std::shared_ptr<const transport::RadiosityBaker> makeRadiosityBaker(const BakeContext& context, const transport::RadiositySettings& settings,
                                                                    TaskRunner& tasks) {
  TaskGraph graph(productVersion());
  const TaskIndex patches = graph.add({"radiosity/patches", "patches", "radiosity/patches", patchParameters(context, settings.patches, settings.seed).text(), {},
                                       double(context.atlas().slots.size()), [&](const TaskInputs& in) {
                                         return transport::makePatchBytes(context.scene(), context.atlas(), *context.tracer(), settings,
                                                                          context.threads(), &in.cancel);
                                       }});
  const auto results = tasks.prepare(graph, std::array{patches});
  return std::make_shared<transport::RadiosityBaker>(context.scene(), context.atlas(), *context.tracer(), settings, *results[0]);
}

RadiosityTasks addRadiosityTasks(TaskGraph& graph, const BakeContext& context, const transport::RadiositySettings& settings,
                                         std::shared_ptr<const transport::RadiosityBaker> baker) {
  const double patches = baker->patchCount();
  const auto hits = addRange(graph, "radiosity", "hits", patchParameters(context, settings.patches, settings.seed).add(settings.rays), baker->patchCount(), kPatchesPerTask, settings.rays, {},
                             [baker](uint32_t first, uint32_t end, const TaskInputs&) { return baker->hits(first, end); });
  const auto direct = addRange(graph, "radiosity", "patch light", patchParameters(context, settings.patches, settings.seed), baker->trainingLightCount(), kLightsPerTask, 4 * patches, {},
                               [baker](uint32_t first, uint32_t end, const TaskInputs&) { return baker->direct(first, end); });
  std::vector<TaskIndex> train_inputs = hits;
  train_inputs.insert(train_inputs.end(), direct.begin(), direct.end());
  const auto train_parameters = patchParameters(context, settings.patches, settings.seed).add(context.keys().reflection).add(settings.rays, settings.training_lights);
  const TaskIndex train = graph.add({"radiosity/train", "form factors", "radiosity/train", train_parameters.text(), train_inputs,
                                     std::max(1.0, patches * settings.training_lights),
                                     [baker, count = hits.size()](const TaskInputs& in) {
                                       const auto views = viewsOf(in.inputs);
                                       return baker->train(std::span(views).first(count), std::span(views).subspan(count));
                                     }});
  auto link_parameters = train_parameters;
  link_parameters.add(settings.links.link_error, settings.links.uneven, settings.links.prune);
  const auto links = addRange(graph, "radiosity", "links", link_parameters, baker->patchCount(), kRowsPerTask, settings.rays, {train},
                  [baker](uint32_t first, uint32_t end, const TaskInputs& in) { return baker->links(first, end, *in.inputs[0]); });
  return {links, train};
}

}  // namespace lightwell::bake
