#include "precompute/plan/probe_scene.h"

#include <algorithm>
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

}  // namespace

SkyProbe probeSky(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint64_t seed) {
  std::vector<double> cumulative;
  double total = 0;
  for (const auto& slot : atlas.slots) cumulative.push_back(total += double(slot.area));
  SkyProbe probe;
  if (!(total > 0)) return probe;
  const Sampler sampler(combineKeys(seed, kProbeStream), 0);
  std::vector<trace::Ray> rays;
  for (uint32_t i = 0; i < kProbingRays; ++i) {
    const double target = total * (i + double(sampler.get1D(i, 0))) / kProbingRays;
    const size_t chosen = std::min<size_t>(size_t(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin()), cumulative.size() - 1);
    const auto& slot = atlas.slots[chosen];
    if (atlas.source[slot.texel] != slot.texel) continue;  // inside or behind other surfaces
    const auto point = atlas::sampleSlot(scene.mesh, atlas, slot, sampler.get1D(i, 1), sampler.get2D(i, 2));
    Vec3 tangent, bitangent;
    orthonormalBasis(point.geometric_normal, tangent, bitangent);
    const Vec3 local = sampleCosineHemisphere(sampler.get2D(i, 3));
    const Vec3 direction = (tangent * local.x + bitangent * local.y + point.geometric_normal * local.z).normalized();
    rays.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, direction), .direction = direction, .key = i});
  }
  std::vector<trace::Hit> hits(rays.size());
  tracer.closest(rays, hits);
  probe.rays = uint32_t(rays.size());
  for (const auto& hit : hits) probe.free += hit.triangle == kNone || isLeaf(scene, hit.triangle);
  return probe;
}

}  // namespace lightwell::plan
