#include "precompute/transport/prm/light_prior.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr float kLooksDown = -0.5f;  // y of the normal of a ceiling, at most

/// Of the free distance along the normal, least and span.
struct HeightShare {
  float least, span;
};

std::vector<PriorLight> overSurfaces(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, bool ceilings, uint32_t count, const Sampler& sampler) {
  std::vector<double> cumulative(atlas.slots.size());
  double total = 0;
  for (size_t i = 0; i < atlas.slots.size(); ++i) cumulative[i] = total += !ceilings || atlas.slots[i].normal.y <= kLooksDown ? atlas.slots[i].area : 0;
  std::vector<PriorLight> lights;
  if (total <= 0) return lights;
  const HeightShare share = ceilings ? HeightShare{0.05f, 0.3f} : HeightShare{0.1f, 0.8f};
  const float most_distance = float(6.0 / scene.metres_per_unit);
  const float least_distance = float(std::min(1e-3 / scene.metres_per_unit, 1e-4 * double((scene.bounds.max - scene.bounds.min).length())));
  const float candela = float(1.0 / (scene.metres_per_unit * scene.metres_per_unit));
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
    const float height = free_distance * (share.least + share.span * sampler.get1D(attempt, 3));
    PriorLight prior;
    prior.light.position = point.position + point.geometric_normal * height;
    prior.light.intensity = Rgb(candela);
    prior.surface_distance_m = height * float(scene.metres_per_unit);
    lights.push_back(prior);
  }
  return lights;
}

std::vector<PriorLight> suns(uint32_t count, const Sampler& sampler) {
  std::vector<PriorLight> lights;
  for (uint32_t i = 0; i < count; ++i) {
    // Uniform over the upper half of the sphere: its height is, too (Archimedes).
    const float up = sampler.get1D(i, 0), azimuth = 2 * std::numbers::pi_v<float> * sampler.get1D(i, 1), across = std::sqrt(std::max(0.0f, 1 - up * up));
    PriorLight& prior = lights.emplace_back();
    prior.light.type = scene::LightType::directional;
    prior.light.direction = Vec3(across * std::cos(azimuth), -up, across * std::sin(azimuth)).normalized();
    prior.light.intensity = Rgb(1.0f);
    prior.surface_distance_m = std::numeric_limits<float>::infinity();
  }
  return lights;
}

std::vector<PriorLight> lampsOf(const scene::Scene& scene, uint32_t count) {
  std::vector<PriorLight> lights;
  for (uint32_t i = 0; i < count && i < scene.lights.size(); ++i) {
    PriorLight& prior = lights.emplace_back(PriorLight{scene.lights[i], std::numeric_limits<float>::infinity()});
    const bool directional = prior.light.type == scene::LightType::directional;
    prior.light.intensity = Rgb(directional ? 1.0f : float(1.0 / (scene.metres_per_unit * scene.metres_per_unit)));
  }
  return lights;
}

std::vector<PriorLight> alongPaths(const scene::Scene& scene, const std::vector<std::vector<Vec3>>& paths, uint32_t count, const Sampler& sampler) {
  struct Segment {
    Vec3 from, to;
  };
  std::vector<Segment> segments;
  std::vector<double> cumulative;
  // A place counts like a line of a tenth of the mean length, so that it is visited at all.
  double length = 0, total = 0;
  size_t lines = 0;
  for (const auto& path : paths)
    for (size_t i = 0; i + 1 < path.size(); ++i) length += double((path[i + 1] - path[i]).length()), ++lines;
  const double place = length > 0 ? 0.1 * length / double(lines) : 1.0;
  for (const auto& path : paths)
    for (size_t i = 0; i < std::max<size_t>(1, path.size() - 1); ++i) {
      const Segment& segment = segments.emplace_back(Segment{path[i], path[std::min(i + 1, path.size() - 1)]});
      cumulative.push_back(total += std::max(double((segment.to - segment.from).length()), path.size() == 1 ? place : 0.0));
    }
  std::vector<PriorLight> lights;
  for (uint32_t i = 0; total > 0 && i < count; ++i) {
    const double target = total * sampler.get1D(i, 0);
    const size_t chosen = std::min<size_t>(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin(), cumulative.size() - 1);
    PriorLight& prior = lights.emplace_back();
    prior.light.position = segments[chosen].from + (segments[chosen].to - segments[chosen].from) * sampler.get1D(i, 1);
    prior.light.intensity = Rgb(float(1.0 / (scene.metres_per_unit * scene.metres_per_unit)));
    prior.surface_distance_m = std::numeric_limits<float>::infinity();
  }
  return lights;
}

}  // namespace

std::vector<PriorLight> samplePriorLights(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const LightPrior& prior, uint32_t count,
                                          uint64_t seed) {
  const Sampler sampler(seed, 0x11647ull);
  switch (prior.places) {
    case LightPrior::Places::sun: return suns(count, sampler);
    case LightPrior::Places::lamps: return lampsOf(scene, count);
    case LightPrior::Places::paths: return alongPaths(scene, prior.paths, count, sampler);
    default: return overSurfaces(scene, atlas, tracer, prior.places == LightPrior::Places::ceilings, count, sampler);
  }
}

}  // namespace lightwell::transport
