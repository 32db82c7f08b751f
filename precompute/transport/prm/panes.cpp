#include "precompute/transport/prm/panes.h"

#include "precompute/core/random.h"
#include "precompute/transport/prm/block_transport.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kWalkStream = 3ull << 40;
constexpr uint32_t kMostBounces = 4096;  // Russian roulette ends walks long before; this bounds a broken albedo

}  // namespace

std::vector<Rgb> gatherPanes(std::span<const uint32_t> slots, const Gatherer& gatherer, const EntryClusters& clusters, const MultiBounce& multi_bounce,
                             uint32_t rays) {
  const BlockTransport transport = gatherBlock(slots, gatherer, rays, clusters.cluster_count);
  std::vector<Rgb> panes(slots.size() * clusters.group_count, Rgb(0.0f));
  const auto once_reflected = multi_bounce.onceReflected(transport.cluster, transport.from_cluster, clusters.group_of_cluster, clusters.group_count);
  for (int channel = 0; channel < 3; ++channel) {
    Eigen::MatrixXf pane = once_reflected[channel] + multi_bounce.furtherReflected(channel, once_reflected[channel]);
    for (size_t l = 0; l < transport.cluster.size(); ++l)
      pane.col(clusters.group_of_cluster[transport.cluster[l]]) += transport.from_cluster[channel].col(Eigen::Index(l));
    for (size_t t = 0; t < slots.size(); ++t)
      for (uint32_t group = 0; group < clusters.group_count; ++group) panes[t * clusters.group_count + group][channel] = std::max(0.0f, pane(t, group));
  }
  return panes;
}

std::vector<WalkVertex> virtualLightWalks(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides,
                                          const EntryClusters& clusters, uint32_t walks_per_entry, uint64_t seed) {
  struct Walk {
    uint32_t number, group;
    atlas::SurfacePoint point;
    Rgb flux_rgb;       // carried, reflected at the current vertex
    Rgb albedo_rgb;     // at the current vertex
  };
  const auto exposedArea = [&](uint32_t side) { return double(atlas.slots[sides.slot[side]].area) * clusters.exposed[side]; };
  std::vector<WalkVertex> vertices;
  std::vector<Walk> walks;
  const Sampler sampler(seed, kWalkStream);
  for (uint32_t group = 0; group < clusters.group_count; ++group) {
    const uint32_t first = clusters.cluster_first_side[clusters.group_first_cluster[group]];
    const uint32_t end = clusters.cluster_first_side[clusters.group_first_cluster[group + 1]];
    const uint32_t entry_cluster = clusters.cluster_count + group;
    const auto& first_entry = clusters.entries.cluster_first_entry;
    const uint32_t starts = (first_entry[entry_cluster + 1] - first_entry[entry_cluster]) * walks_per_entry;
    const float area = clusters.area[entry_cluster];
    uint32_t at = first;
    double reached = exposedArea(clusters.cluster_side[first]);
    for (uint32_t k = 0; k < starts; ++k) {
      const uint32_t number = uint32_t(walks.size());
      const double target = area * (k + 0.5) / starts;
      while (reached < target && at + 1 < end) {
        ++at;
        reached += exposedArea(clusters.cluster_side[at]);
      }
      const uint32_t side = clusters.cluster_side[at];
      const auto point = sampleSide(scene.mesh, atlas, sides, side, sampler.get1D(number, 0), sampler.get2D(number, 1));
      // Unit irradiance on the share of the group's area that this walk stands for: flux = albedo × area / walks.
      const Rgb albedo_rgb = atlas.slots[sides.slot[side]].albedo_rgb;
      walks.push_back({number, entry_cluster, point, albedo_rgb * (area / float(starts)), albedo_rgb});
    }
  }
  std::vector<trace::Ray> rays;
  std::vector<trace::Hit> hits;
  std::vector<Walk> alive;
  for (uint32_t bounce = 0; !walks.empty() && bounce < kMostBounces; ++bounce) {
    rays.clear();
    alive.clear();
    for (auto& walk : walks) {
      vertices.push_back({walk.group, walk.point.position, walk.point.normal, walk.flux_rgb});
      const float albedo = luminance(walk.albedo_rgb);
      if (sampler.get1D(walk.number, 8 + 4 * bounce) >= albedo) continue;
      walk.flux_rgb /= albedo;
      Vec3 tangent, bitangent;
      orthonormalBasis(walk.point.normal, tangent, bitangent);
      const Vec3 local = sampleCosineHemisphere(sampler.get2D(walk.number, 9 + 4 * bounce));
      const Vec3 direction = (tangent * local.x + bitangent * local.y + walk.point.normal * local.z).normalized();
      if (direction.dot(walk.point.geometric_normal) <= 0.0f) continue;
      rays.push_back({.origin = trace::Tracer::offsetOrigin(walk.point.position, walk.point.geometric_normal, direction), .direction = direction,
                      .key = mixBits(combineKeys(kWalkStream + bounce, walk.number))});
      alive.push_back(walk);
    }
    hits.assign(rays.size(), {});
    tracer.closest(rays, hits);
    walks.clear();
    for (size_t i = 0; i < hits.size(); ++i) {
      if (hits[i].triangle == kNone) continue;
      const uint32_t slot = atlas.slotAt(scene.mesh, hits[i].triangle, hits[i].u, hits[i].v);
      const uint32_t side = sides.met(slot, hits[i].front);
      if (side == kNone) continue;
      Walk walk = alive[i];
      walk.point = {hits[i].triangle, hits[i].u, hits[i].v, rays[i].origin + rays[i].direction * hits[i].t, hits[i].geometric_normal,
                    hits[i].geometric_normal};
      walk.albedo_rgb = atlas.slots[slot].albedo_rgb;
      walk.flux_rgb *= walk.albedo_rgb;
      walks.push_back(walk);
    }
  }
  return vertices;
}

std::vector<Rgb> walkPanes(std::span<const uint32_t> slots, const atlas::Atlas& atlas, const trace::Tracer& tracer, const EntryClusters& clusters,
                           std::span<const WalkVertex> lights) {
  std::vector<Rgb> panes(slots.size() * clusters.group_count, Rgb(0.0f));
  std::vector<trace::Ray> rays;
  std::vector<float> form_factor, visibility;
  std::vector<uint32_t> which;
  for (size_t t = 0; t < slots.size(); ++t) {
    const auto& slot = atlas.slots[slots[t]];
    rays.clear();
    form_factor.clear();
    which.clear();
    for (uint32_t i = 0; i < lights.size(); ++i) {
      const Vec3 between = lights[i].position - slot.position;
      const float distance2 = between.length2();
      if (distance2 <= 0.0f) continue;
      const float distance = std::sqrt(distance2);
      const Vec3 direction = between / distance;
      const float cos_texel = slot.normal.dot(direction), cos_light = -lights[i].normal.dot(direction);
      if (cos_texel <= 0.0f || cos_light <= 0.0f) continue;
      const Vec3 origin = trace::Tracer::offsetOrigin(slot.position, slot.normal, direction);
      rays.push_back({.origin = origin, .direction = direction, .t_max = distance * (1.0f - 1e-4f), .key = i});
      form_factor.push_back(cos_texel * cos_light / (kPi * distance2));
      which.push_back(i);
    }
    visibility.assign(rays.size(), 0.0f);
    tracer.transmittance(rays, visibility);
    for (size_t i = 0; i < which.size(); ++i) {
      const auto& light = lights[which[i]];
      panes[t * clusters.group_count + (light.cluster - clusters.cluster_count)] += light.exitant_rgb * (form_factor[i] * visibility[i]);
    }
  }
  return panes;
}

}  // namespace lightwell::transport
