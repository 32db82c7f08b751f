#include "precompute/transport/side_rays.h"

#include <algorithm>

#include "precompute/core/random.h"

namespace lightwell::transport {

std::vector<trace::Ray> cosineRays(const scene::Mesh& mesh, const atlas::Atlas& atlas, const Sides& sides, std::span<const uint32_t> members,
                                   uint32_t rays, uint64_t seed, uint64_t stream) {
  const Sampler sampler(seed, stream);
  std::vector<double> cumulative(members.size());
  double total = 0;
  for (size_t i = 0; i < members.size(); ++i) cumulative[i] = total += atlas.slots[sides.slot[members[i]]].area;
  std::vector<trace::Ray> list;
  list.reserve(rays);
  for (uint32_t i = 0; i < rays; ++i) {
    const double target = total * (i + 0.5) / rays;
    const size_t chosen = std::min<size_t>(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin(), members.size() - 1);
    const auto point = sampleSide(mesh, atlas, sides, members[chosen], sampler.get1D(i, 0), sampler.get2D(i, 1));
    Vec3 tangent, bitangent;
    orthonormalBasis(point.normal, tangent, bitangent);
    const Vec3 local = sampleCosineHemisphere(sampler.get2D(i, 2));
    const Vec3 direction = (tangent * local.x + bitangent * local.y + point.normal * local.z).normalized();
    if (direction.dot(point.geometric_normal) <= 0.0f) continue;
    list.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, direction), .direction = direction,
                    .key = mixBits(combineKeys(stream, i))});
  }
  return list;
}

}  // namespace lightwell::transport
