// The paper's form of a precomputed radiance map: one pane of irradiance per cluster of entry points, estimated in two ways.
#pragma once
#include "precompute/transport/prm/multi_bounce.h"

namespace lightwell::transport {

/// Panes of the texels `slots` by gathering: transport to clusters, further bounces gathered at them. The panes are over groups:
/// [texel][group] per channel, row-major.
std::vector<Rgb> gatherPanes(std::span<const uint32_t> slots, const Gatherer& gatherer, const EntryClusters& clusters, const MultiBounce& multi_bounce,
                             uint32_t rays);

/// A diffuse virtual light of a walk that started at an entry point of unit irradiance.
struct WalkVertex {
  uint32_t cluster;        // of the entry point that the walk started from, as in PrmEntries
  Vec3 position, normal;
  Rgb exitant_rgb;         // flux it reflects; the irradiance it gives is exitant_rgb / π × geometric term
};

/// The walks of "On Making Light Maps Dynamic", section 2.1: from every entry point of the groups, cosine-distributed directions, quasi-random,
/// ended by Russian roulette with the luminance of the albedo (equations 1 and 2). Deterministic in `seed`.
std::vector<WalkVertex> virtualLightWalks(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides,
                                          const EntryClusters& clusters, uint32_t walks_per_entry, uint64_t seed);

/// Panes of the texels `slots` by connecting every texel with every virtual light by a shadow ray (equation 3). Texels are their centroids, as in
/// the paper; the geometric term is not bounded, so corners show its spikes: this is the baseline, not the product's default.
/// [texel][group], as gatherPanes.
std::vector<Rgb> walkPanes(std::span<const uint32_t> slots, const atlas::Atlas& atlas, const trace::Tracer& tracer, const EntryClusters& clusters,
                           std::span<const WalkVertex> lights);

}  // namespace lightwell::transport
