#include "precompute/transport/prm/gather.h"

#include <algorithm>

#include "precompute/core/random.h"
#include "precompute/transport/side_rays.h"
#include "precompute/transport/sphere_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kSideStream = 1ull << 40, kMeanStream = 2ull << 40, kProbeStream = 3ull << 40, kBundleStream = 4ull << 40;  // owners of random streams never meet
// A texel is small beside how far its rays go: fewer starting points than directions do.
constexpr uint32_t kRaysPerPoint = 4;
constexpr uint32_t kTurnDimension = 2;

}  // namespace

/// `backs`: receives how many rays met the unlit backs of surfaces.
std::vector<Gatherer::Hit> Gatherer::clustersMet(std::span<const trace::Hit> hits, uint32_t& backs) const {
  std::vector<Hit> met;
  met.reserve(hits.size());
  backs = 0;
  for (const auto& hit : hits) {
    if (hit.triangle == kNone) continue;
    const uint32_t slot = atlas_.slotAt(scene_.mesh, hit.triangle, hit.u, hit.v);
    const uint32_t side = sides_.met(slot, hit.front);
    if (side == kNone) ++backs;
    else if (clusters_.cluster_of_side[side] != kNone) met.push_back({clusters_.cluster_of_side[side], atlas_.slots[slot].albedo_rgb});
  }
  return met;
}

HemisphereBundle Gatherer::bundle(uint32_t rays, uint64_t owner) const { return {rays, seed_, kBundleStream + owner}; }

std::vector<trace::Ray> Gatherer::rays(uint32_t side, const HemisphereBundle& bundle) const {
  const Sampler sampler(seed_, kSideStream + side);
  const float turn = 2 * kPi * sampler.get1D(0, kTurnDimension), turn_cos = std::cos(turn), turn_sin = std::sin(turn);
  std::vector<trace::Ray> rays;
  rays.reserve(bundle.directions.size());
  atlas::SurfacePoint point;
  Vec3 tangent(0.0f), bitangent(0.0f);
  for (uint32_t i = 0; i < bundle.directions.size(); ++i) {
    if (i % kRaysPerPoint == 0) {
      point = sampleSide(scene_.mesh, atlas_, sides_, side, sampler.get1D(i / kRaysPerPoint, 0), sampler.get2D(i / kRaysPerPoint, 1));
      Vec3 first, second;
      orthonormalBasis(point.normal, first, second);
      tangent = first * turn_cos + second * turn_sin, bitangent = second * turn_cos - first * turn_sin;
    }
    const Vec3& local = bundle.directions[i];
    const Vec3 direction = tangent * local.x + bitangent * local.y + point.normal * local.z;
    if (!(direction.dot(point.geometric_normal) > 0.0f)) continue;
    rays.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, direction), .direction = direction,
                    .key = mixBits(combineKeys(kSideStream + side, i))});
  }
  return rays;
}

std::vector<Gatherer::Hit> Gatherer::hits(uint32_t side, const HemisphereBundle& bundle) const {
  const auto rays = this->rays(side, bundle);
  std::vector<trace::Hit> hits(rays.size());
  tracer_.closest(rays, hits);
  uint32_t backs;
  return clustersMet(hits, backs);
}

Rgb Gatherer::emittedIrradiance(uint32_t side, uint32_t rays) const {
  const auto list = cosineRays(scene_.mesh, atlas_, sides_, {&side, 1}, rays, seed_, kSideStream + side);
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
  const auto list = meanRays(members, rays, owner);
  std::vector<trace::Hit> hits(list.size());
  tracer_.closest(list, hits);
  uint32_t backs;
  std::vector<Hit> met = clustersMet(hits, backs);
  std::stable_sort(met.begin(), met.end(), [](const Hit& a, const Hit& b) { return a.cluster < b.cluster; });
  GatherRow row;
  const float share = 1.0f / float(rays > backs ? rays - backs : 1);
  for (const auto& [cluster, albedo_rgb] : met) {
    if (row.cluster.empty() || row.cluster.back() != cluster) {
      row.cluster.push_back(cluster);
      row.transfer_rgb.emplace_back(0.0f);
    }
    row.transfer_rgb.back() += albedo_rgb * share;
  }
  return row;
}

std::vector<std::pair<uint32_t, uint32_t>> Gatherer::met(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const {
  const auto list = meanRays(members, rays, owner);
  std::vector<trace::Hit> hits(list.size());
  tracer_.closest(list, hits);
  std::vector<uint32_t> clusters;
  uint32_t backs;
  for (const Hit& hit : clustersMet(hits, backs)) clusters.push_back(hit.cluster);
  std::sort(clusters.begin(), clusters.end());
  std::vector<std::pair<uint32_t, uint32_t>> counts;
  for (const uint32_t cluster : clusters) {
    if (counts.empty() || counts.back().first != cluster) counts.emplace_back(cluster, 0);
    ++counts.back().second;
  }
  return counts;
}

}  // namespace lightwell::transport
