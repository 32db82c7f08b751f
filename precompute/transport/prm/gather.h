// One gathered bounce: what a point receives from the clusters around it, per unit irradiance on each.
#pragma once
#include <span>

#include "precompute/trace/tracer.h"
#include "precompute/transport/prm/entries.h"
#include "precompute/transport/prm/hemisphere_bundle.h"

namespace lightwell::transport {

/// One sparse row: irradiance received = Σ transfer_rgb[i] * irradiance_rgb(cluster[i]). Clusters ascend.
struct GatherRow {
  std::vector<uint32_t> cluster;
  std::vector<Rgb> transfer_rgb;
};

/// Gathers over the hemisphere with cosine-distributed rays: with E the irradiance and a the albedo met, the mean of a·E over the rays is the
/// irradiance received (the 1/π of the albedo and the π of the cosine density cancel). No geometric term, so no spikes near corners.
/// Rays that would leave below the geometric surface carry nothing, but count.
class Gatherer {
 public:
  Gatherer(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides,
           const EntryClusters& clusters, uint64_t seed)
      : scene_(scene), atlas_(atlas), tracer_(tracer), sides_(sides), clusters_(clusters), seed_(seed) {}

  struct Hit {
    uint32_t cluster;
    Rgb albedo_rgb;
  };
  /// Directions for hits(), for texels that share `owner`.
  HemisphereBundle bundle(uint32_t rays, uint64_t owner) const;
  /// The rays that hits() traces, fewer where some would leave below the surface.
  std::vector<trace::Ray> rays(uint32_t side, const HemisphereBundle& bundle) const;
  /// What rays from one texel's side into the directions of `bundle`, turned at random about the normal, meet of clusters: the sum of albedos times irradiance, over the
  /// number of directions, is what the side receives.
  std::vector<Hit> hits(uint32_t side, const HemisphereBundle& bundle) const;
  /// The area-weighted mean row over the exposed surface of the sides `members` of a cluster or group: rays that meet the unlit backs of surfaces began
  /// inside of something and do not count. `owner` keys the random numbers.
  GatherRow mean(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const;
  /// What rays from a point in the air meet, even over the sphere. Those that leave the scene or meet unlit backs are not in the list.
  struct Met {
    uint32_t cluster;
    Rgb albedo_rgb, emitted_radiance_rgb;
    Vec3 direction;
  };
  std::vector<Met> around(const Vec3& point, uint32_t rays, uint64_t owner) const;
  /// How many of `rays` rays of mean() meet each cluster: (cluster, count), clusters ascend.
  std::vector<std::pair<uint32_t, uint32_t>> met(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const;
  /// Irradiance that one texel's side receives straight from emitting surfaces.
  Rgb emittedIrradiance(uint32_t side, uint32_t rays) const;

 private:
  std::vector<trace::Ray> meanRays(std::span<const uint32_t> members, uint32_t rays, uint64_t owner) const;
  std::vector<Hit> clustersMet(std::span<const trace::Hit> hits, uint32_t& backs) const;
  const scene::Scene& scene_;
  const atlas::Atlas& atlas_;
  const trace::Tracer& tracer_;
  const Sides& sides_;
  const EntryClusters& clusters_;
  uint64_t seed_;
};

}  // namespace lightwell::transport
