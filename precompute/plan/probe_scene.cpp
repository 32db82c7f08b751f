#include "precompute/plan/probe_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "precompute/core/math.h"
#include "precompute/core/random.h"

namespace lightwell::plan {
namespace {

constexpr uint64_t kProbeStream = 0x736b7970726f6265ull;

bool isLeaf(const scene::Scene& scene, uint32_t triangle) {
  return std::any_of(scene.portals.begin(), scene.portals.end(), [&](const scene::Portal& portal) {
    return triangle >= portal.first_triangle && triangle < portal.first_triangle + portal.triangle_count;
  });
}

/// `rays_each` cosine-distributed rays from each of `places` uniform by area on the surfaces; those inside or behind other surfaces send none.
struct ProbingRays {
  std::vector<trace::Ray> rays;
  std::vector<const atlas::Slot*> slot;  // [rays]: where it starts

  ProbingRays(const scene::Scene& scene, const atlas::Atlas& atlas, uint64_t seed, uint32_t places, uint32_t rays_each) {
    std::vector<double> cumulative;
    double total = 0;
    for (const auto& s : atlas.slots) cumulative.push_back(total += double(s.area));
    if (!(total > 0)) return;
    const Sampler sampler(combineKeys(seed, kProbeStream), 0);
    for (uint32_t i = 0; i < places; ++i) {
      const double target = total * (i + double(sampler.get1D(i, 0))) / places;
      const size_t chosen = std::min<size_t>(size_t(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin()), cumulative.size() - 1);
      const auto& place = atlas.slots[chosen];
      if (atlas.source[place.texel] != place.texel) continue;
      const auto point = atlas::sampleSlot(scene.mesh, atlas, place, sampler.get1D(i, 1), sampler.get2D(i, 2));
      Vec3 tangent, bitangent;
      orthonormalBasis(point.geometric_normal, tangent, bitangent);
      for (uint32_t ray = i * rays_each; ray < (i + 1) * rays_each; ++ray) {
        const Vec3 local = sampleCosineHemisphere(sampler.get2D(ray, 3));
        const Vec3 direction = (tangent * local.x + bitangent * local.y + point.geometric_normal * local.z).normalized();
        rays.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, direction), .direction = direction, .key = ray});
        slot.push_back(&place);
      }
    }
  }
};

}  // namespace

SkyProbe probeSky(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint64_t seed) {
  const ProbingRays probing(scene, atlas, seed, kProbingRays, 1);
  std::vector<trace::Hit> hits(probing.rays.size());
  tracer.closest(probing.rays, hits);
  SkyProbe probe;
  probe.rays = uint32_t(hits.size());
  for (const auto& hit : hits) probe.free += hit.triangle == kNone || isLeaf(scene, hit.triangle);
  return probe;
}

double probeVariation(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint64_t seed) {
  constexpr uint32_t kRaysEach = 16;
  const ProbingRays probing(scene, atlas, seed, kProbingRays / kRaysEach, kRaysEach);
  std::vector<trace::Hit> hits(probing.rays.size());
  tracer.closest(probing.rays, hits);
  double sum = 0;
  for (size_t first = 0; first < hits.size(); first += kRaysEach) {
    const double width = std::sqrt(double(probing.slot[first]->area));
    double nearness = 0;  // one over the harmonic mean distance; what is nearer than half a texel is no place of its own
    for (size_t i = first; i < first + kRaysEach; ++i)
      if (hits[i].triangle != kNone) nearness += 1 / std::max(double(hits[i].t), 0.5 * width) / kRaysEach;
    sum += std::min(1.0, 4 / std::numbers::pi * width / std::sqrt(6.0) * nearness);
  }
  return hits.empty() ? 0 : sum / double(hits.size() / kRaysEach);
}

}  // namespace lightwell::plan
