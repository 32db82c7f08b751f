#include "precompute/bake/probe_tasks.h"

#include <array>
#include <cmath>

#include "precompute/bake/bake.h"

namespace lightwell::bake {
namespace {

constexpr uint32_t kProbesPerTask = 256;

Parameters placeParameters(const BakeContext& context, const transport::RadiositySettings& radiosity, const transport::ProbeOptions& p) {
  Parameters parameters = patchParameters(context, radiosity.patches, radiosity.seed).add(p.spacing, p.budget, p.seed);
  for (const Vec3& point : p.points) parameters.add(point.x, point.y, point.z);
  return parameters;
}

}  // namespace

std::vector<Vec3> probePoints(const plan::Settings& settings, const scene::Scene& scene) {
  std::vector<Vec3> points(settings.probe_points_m.size());
  for (size_t i = 0; i < points.size(); ++i)
    for (int k = 0; k < 3; ++k) points[i][k] = float((settings.probe_points_m[i][size_t(k)] - scene.origin_m[k]) / scene.metres_per_unit);
  return points;
}

transport::ProbeSettings probeSettings(const plan::Settings& settings, const scene::Scene& scene) {
  transport::ProbeSettings probes;
  probes.places.seed = settings.seed;
  probes.places.budget = 2000;
  switch (settings.quality) {
    case plan::Quality::draft: probes.places.budget = 500, probes.links.rays = 512, probes.links.error = 0.04f; break;
    case plan::Quality::preview: probes.places.budget = 1000, probes.links.rays = 1536, probes.links.error = 0.025f; break;
    case plan::Quality::production: break;  // the estimator's defaults
  }
  probes.links.error /= std::exp2(float(settings.refinement));
  if (settings.refinement > 0) probes.links.rays *= 1u << settings.refinement;
  if (settings.probe_spacing_m != plan::kAutomaticProbeSpacing) {
    probes.places.budget = 0;
    probes.places.spacing = float(settings.probe_spacing_m / scene.metres_per_unit);
  }
  probes.places.points = probePoints(settings, scene);
  return probes;
}

ProbesToBake makeProbeBaker(const BakeContext& context, const plan::Settings& settings, std::shared_ptr<const transport::RadiosityBaker> radiosity,
                            TaskRunner& tasks) {
  ProbesToBake probes{std::move(radiosity), probeSettings(settings, context.scene()), nullptr};
  TaskGraph graph(productVersion());
  const TaskIndex places = graph.add({"probes/places", "probes", "probes/places", placeParameters(context, radiositySettings(settings), probes.settings.places).text(), {},
                                      double(context.atlas().slots.size()), [&](const TaskInputs& in) {
                                        return transport::makeProbeBytes(context.scene(), *context.tracer(), *probes.radiosity, probes.settings,
                                                                         context.threads(), &in.cancel);
                                      }});
  const auto results = tasks.prepare(graph, std::array{places});
  probes.baker = std::make_shared<transport::ProbeBaker>(*probes.radiosity, probes.settings, *results[0]);
  return probes;
}

std::vector<TaskIndex> addProbeTasks(TaskGraph& graph, const BakeContext& context, const ProbesToBake& probes, const transport::RadiositySettings& radiosity_settings,
                                     const RadiosityTasks& radiosity) {
  const auto baker = probes.baker;
  const transport::ProbeLinkOptions& s = probes.settings.links;
  Parameters hit_parameters = placeParameters(context, radiosity_settings, probes.settings.places).add(s.rays);
  const auto hits = addRange(graph, "probes", "probe hits", hit_parameters, baker->probes().count(), kProbesPerTask, s.rays, {},
                             [baker](uint32_t first, uint32_t end, const TaskInputs&) { return baker->hits(first, end); });
  const Parameters link_parameters = hit_parameters.add(context.keys().reflection).add(s.error, s.uneven, s.most_lights);
  std::vector<TaskIndex> links;
  for (size_t i = 0; i < hits.size(); ++i)
    links.push_back(graph.add({"probes/links/" + std::to_string(i), "probe links", "probes/links", link_parameters.text() + " " + std::to_string(i), {hits[i], radiosity.train},
                               double(s.rays) * kProbesPerTask, [baker, i](const TaskInputs& in) { return baker->links(uint32_t(i) * kProbesPerTask, *in.inputs[0], *in.inputs[1]); }}));
  return links;
}

}  // namespace lightwell::bake
