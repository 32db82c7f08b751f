#include "precompute/transport/prm/gather.h"

#include <algorithm>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kSideStream = 1ull << 40, kMeanStream = 2ull << 40;  // owners of random streams never meet

/// Appends the cosine-distributed ray of `sample`; none when it would leave below the geometric surface.
void appendRay(const atlas::SurfacePoint& point, const Vec2& u, uint32_t key, std::vector<trace::Ray>& rays) {
  Vec3 tangent, bitangent;
  orthonormalBasis(point.normal, tangent, bitangent);
  const Vec3 local = sampleCosineHemisphere(u);
  const Vec3 direction = (tangent * local.x + bitangent * local.y + point.normal * local.z).normalized();
  if (direction.dot(point.geometric_normal) <= 0.0f) return;
  rays.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, direction), .direction = direction, .key = key});
}

}  // namespace

GatherRow Gatherer::trace(std::span<const trace::Ray> rays, uint32_t denominator) const {
  std::vector<trace::Hit> hits(rays.size());
  tracer_.closest(rays, hits);
  std::vector<std::pair<uint32_t, Rgb>> met;
  met.reserve(hits.size());
  for (const auto& hit : hits) {
    if (hit.triangle == kNone) continue;
    const uint32_t slot = atlas_.slotAt(scene_.mesh, hit.triangle, hit.u, hit.v);
    const uint32_t side = sides_.met(slot, hit.front);
    if (side == kNone || clusters_.cluster_of_side[side] == kNone) continue;
    met.emplace_back(clusters_.cluster_of_side[side], atlas_.slots[slot].albedo_rgb);
  }
  std::stable_sort(met.begin(), met.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  GatherRow row;
  const float share = 1.0f / float(denominator);
  for (const auto& [cluster, albedo_rgb] : met) {
    if (row.cluster.empty() || row.cluster.back() != cluster) {
      row.cluster.push_back(cluster);
      row.transfer_rgb.emplace_back(0.0f);
    }
    row.transfer_rgb.back() += albedo_rgb * share;
  }
  return row;
}

std::vector<trace::Ray> Gatherer::sideRays(uint32_t side, uint32_t rays) const {
  const Sampler sampler(seed_, kSideStream + side);
  std::vector<trace::Ray> list;
  list.reserve(rays);
  for (uint32_t i = 0; i < rays; ++i)
    appendRay(sampleSide(scene_.mesh, atlas_, sides_, side, sampler.get1D(i, 0), sampler.get2D(i, 1)), sampler.get2D(i, 2),
              mixBits(combineKeys(kSideStream + side, i)), list);
  return list;
}

GatherRow Gatherer::side(uint32_t side, uint32_t rays) const { return trace(sideRays(side, rays), rays); }

Rgb Gatherer::emittedIrradiance(uint32_t side, uint32_t rays) const {
  const auto list = sideRays(side, rays);
  std::vector<trace::Hit> hits(list.size());
  tracer_.closest(list, hits);
  Rgb radiance_rgb(0.0f);
  for (const auto& hit : hits) {
    if (hit.triangle == kNone) continue;
    const uint32_t slot = atlas_.slotAt(scene_.mesh, hit.triangle, hit.u, hit.v);
    if (sides_.met(slot, hit.front) != kNone) radiance_rgb += atlas_.slots[slot].emitted_radiance_rgb;
  }
  return radiance_rgb * (kPi / float(rays));
}

std::vector<trace::Ray> Gatherer::meanRays(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const {
  const Sampler sampler(seed_, kMeanStream + owner);
  std::vector<double> cumulative(members.size());
  double total = 0;
  for (size_t i = 0; i < members.size(); ++i) cumulative[i] = total += atlas_.slots[sides_.slot[members[i]]].area;
  std::vector<trace::Ray> list;
  list.reserve(rays);
  for (uint32_t i = 0; i < rays; ++i) {
    const double target = total * (i + 0.5) / rays;
    const size_t chosen = std::min<size_t>(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin(), members.size() - 1);
    appendRay(sampleSide(scene_.mesh, atlas_, sides_, members[chosen], sampler.get1D(i, 0), sampler.get2D(i, 1)), sampler.get2D(i, 2),
              mixBits(combineKeys(kMeanStream + owner, i)), list);
  }
  return list;
}

GatherRow Gatherer::mean(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const {
  return trace(meanRays(members, rays, owner), rays);
}

std::vector<std::pair<uint32_t, uint32_t>> Gatherer::met(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const {
  const auto list = meanRays(members, rays, owner);
  std::vector<trace::Hit> hits(list.size());
  tracer_.closest(list, hits);
  std::vector<uint32_t> clusters;
  for (const auto& hit : hits) {
    if (hit.triangle == kNone) continue;
    const uint32_t side = sides_.met(atlas_.slotAt(scene_.mesh, hit.triangle, hit.u, hit.v), hit.front);
    if (side != kNone && clusters_.cluster_of_side[side] != kNone) clusters.push_back(clusters_.cluster_of_side[side]);
  }
  std::sort(clusters.begin(), clusters.end());
  std::vector<std::pair<uint32_t, uint32_t>> counts;
  for (const uint32_t cluster : clusters) {
    if (counts.empty() || counts.back().first != cluster) counts.emplace_back(cluster, 0);
    ++counts.back().second;
  }
  return counts;
}

}  // namespace lightwell::transport
