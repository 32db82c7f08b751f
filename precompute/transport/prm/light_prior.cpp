#include "precompute/transport/prm/light_prior.h"

#include <algorithm>

#include "precompute/core/random.h"

namespace lightwell::transport {

std::vector<PriorLight> samplePriorLights(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint32_t count, uint64_t seed) {
  std::vector<double> cumulative(atlas.slots.size());
  double total = 0;
  for (size_t i = 0; i < atlas.slots.size(); ++i) cumulative[i] = total += atlas.slots[i].area;
  std::vector<PriorLight> lights;
  if (total <= 0) return lights;
  const float most_distance = float(6.0 / scene.metres_per_unit);
  const float least_distance = float(std::min(1e-3 / scene.metres_per_unit, 1e-4 * double((scene.bounds.max - scene.bounds.min).length())));
  const float candela = float(1.0 / (scene.metres_per_unit * scene.metres_per_unit));
  const Sampler sampler(seed, 0x11647ull);
  // A point whose way up is shut at once (inside another object) is skipped; the next one takes its place.
  for (uint32_t attempt = 0; lights.size() < count && attempt < 16 * count; ++attempt) {
    const double target = total * sampler.get1D(attempt, 0);
    const size_t chosen = std::min<size_t>(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin(), cumulative.size() - 1);
    const auto point = atlas::sampleSlot(scene.mesh, atlas, atlas.slots[chosen], sampler.get1D(attempt, 1), sampler.get2D(attempt, 2));
    const trace::Ray up{.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, point.geometric_normal),
                        .direction = point.geometric_normal, .key = attempt};
    trace::Hit hit;
    tracer.closest({&up, 1}, {&hit, 1});
    if (hit.triangle != kNone && !hit.front && !scene.materials[scene.mesh.triangle_material[hit.triangle]].double_sided) continue;
    const float free_distance = hit.triangle == kNone ? most_distance : std::min(hit.t, most_distance);
    if (free_distance < least_distance) continue;
    const float height = free_distance * (0.1f + 0.8f * sampler.get1D(attempt, 3));
    PriorLight prior;
    prior.light.position = point.position + point.geometric_normal * height;
    prior.light.intensity = Rgb(candela);
    prior.surface_distance_m = height * float(scene.metres_per_unit);
    lights.push_back(prior);
  }
  return lights;
}

}  // namespace lightwell::transport
