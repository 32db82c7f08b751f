#include "precompute/transport/prm/gather.h"

#include <algorithm>

#include "precompute/transport/side_rays.h"
#include "precompute/transport/sphere_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kSideStream = 1ull << 40, kMeanStream = 2ull << 40, kProbeStream = 3ull << 40;  // owners of random streams never meet

}  // namespace

GatherRow Gatherer::trace(std::span<const trace::Ray> rays, uint32_t denominator, bool backs_count) const {
  std::vector<trace::Hit> hits(rays.size());
  tracer_.closest(rays, hits);
  std::vector<std::pair<uint32_t, Rgb>> met;
  met.reserve(hits.size());
  for (const auto& hit : hits) {
    if (hit.triangle == kNone) continue;
    const uint32_t slot = atlas_.slotAt(scene_.mesh, hit.triangle, hit.u, hit.v);
    const uint32_t side = sides_.met(slot, hit.front);
    if (side == kNone && !backs_count && denominator > 1) --denominator;
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
  return cosineRays(scene_.mesh, atlas_, sides_, {&side, 1}, rays, seed_, kSideStream + side);
}

GatherRow Gatherer::side(uint32_t side, uint32_t rays) const { return trace(sideRays(side, rays), rays, true); }

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

std::vector<Gatherer::Met> Gatherer::around(const Vec3& point, uint32_t rays, uint64_t owner) const {
  const auto list = sphereRays(point, rays, seed_, kProbeStream + owner);
  std::vector<trace::Hit> hits(list.size());
  tracer_.closest(list, hits);
  std::vector<Met> met;
  for (size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].triangle == kNone) continue;
    const auto& slot = atlas_.slots[atlas_.slotAt(scene_.mesh, hits[i].triangle, hits[i].u, hits[i].v)];
    const uint32_t side = sides_.met(uint32_t(&slot - atlas_.slots.data()), hits[i].front);
    if (side != kNone && clusters_.cluster_of_side[side] != kNone)
      met.push_back({clusters_.cluster_of_side[side], slot.albedo_rgb, slot.emitted_radiance_rgb, list[i].direction});
  }
  return met;
}

std::vector<trace::Ray> Gatherer::meanRays(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const {
  return cosineRays(scene_.mesh, atlas_, sides_, members, rays, seed_, kMeanStream + owner);
}

GatherRow Gatherer::mean(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const {
  return trace(meanRays(members, rays, owner), rays, false);
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
