// A coarse solution of the whole scene's light, looked up where gathered rays end: all bounces but the last cost nothing more.
//
// Ward, Heckbert, "Irradiance Gradients" (1992) and Jensen, "Global Illumination using Photon Maps" (1996) have this shape: a cheap estimate of indirect light on surfaces behind one exact gathering
// step. Here the estimate is radiosity between patches.
#pragma once
#include <span>
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/radiosity/patches.h"

namespace lightwell::transport {

/// What the rays of some patches met, row after row: other patches, once for each ray.
struct CacheRows {
  std::vector<uint32_t> first = {0};  // rows + 1
  std::vector<uint32_t> patch;        // ascending within a row
  std::vector<uint16_t> count;
};

/// `rays` (at most 65535) rays from each of the patches [begin, end). What does not meet a patch brings nothing.
CacheRows cacheRows(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches, uint32_t rays,
                    uint64_t seed, uint32_t begin, uint32_t end);

/// Radiosity of every side of the exposed surface: albedo × (direct light at the side + light from other patches, interpolated between them); zero for sides
/// without a patch. `direct_rgb` and `exposed` per side: mean irradiance over the whole side, and the share of it that is in the open. `rows` of all patches,
/// in range order. What emitters emit is not in it.
std::vector<Rgb> sideRadiosity(const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches,
                               std::span<const CacheRows> rows, uint32_t rays, std::span<const float> exposed, std::span<const Rgb> direct_rgb,
                               const CancelFlag* cancel);

}  // namespace lightwell::transport
