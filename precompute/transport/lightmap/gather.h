// Final gathering: indirect irradiance of texels from rays that end in the cached solution.
#pragma once
#include <span>
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

/// Two independent estimates of each slot's indirect irradiance, from half of the rays each: their difference tells the error.
struct GatheredPair {
  std::vector<Rgb> a_rgb, b_rgb;
};

/// `rays` (even) rays from each of the slots [first, end), over its whole surface. `radiosity_rgb` per side.
GatheredPair gatherSlots(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, std::span<const Rgb> radiosity_rgb,
                         uint32_t rays, uint64_t seed, uint32_t first, uint32_t end, const CancelFlag* cancel);

}  // namespace lightwell::transport
