// Final gathering: indirect irradiance of texels from rays that end in the cached solution.
#pragma once
#include <span>
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/lightmap/tilt.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

/// Two independent estimates of irradiance, from half of the rays each: their difference tells the error.
struct GatheredPair {
  std::vector<Rgb> a_rgb, b_rgb;
  std::vector<Vec3> gradient;  // of both together: irradiance in luminance times how it changes with the normal (tilt.h); or empty
};

/// Indirect irradiance from `rays` (even) rays from each of the slots [first, end), over its whole surface. `radiosity_rgb` per side; `tilt` null: without gradients.
GatheredPair gatherSlots(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, std::span<const Rgb> radiosity_rgb,
                         uint32_t rays, uint64_t seed, const TiltKernel* tilt, uint32_t first, uint32_t end, const CancelFlag* cancel);

}  // namespace lightwell::transport
