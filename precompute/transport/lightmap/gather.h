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

class DirectSampler;

/// What rays end in.
struct GatherSource {
  std::span<const Rgb> radiosity_rgb;         // per side
  std::span<const Rgb> direct_radiosity_rgb;  // per side, the part that `direct` samples; or empty
  std::span<const uint8_t> uneven;            // per slot: LookUp of direct_light.h
  DirectSampler* direct = nullptr;            // for hits on these and for near ones, where the means of texels are too coarse; null: texels are fine enough
};

struct GatherOptions {
  std::span<const uint32_t> rays;    // per slot of the range, even
  uint32_t round = 0;                // 0 or 1: rays of different rounds are independent
  const TiltKernel* tilt = nullptr;  // null: without gradients
  uint64_t seed = 1;
};

/// Indirect irradiance of each of the slots [first, end), over its whole surface.
GatheredPair gatherSlots(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const GatherSource& source,
                         const GatherOptions& options, uint32_t first, uint32_t end, const CancelFlag* cancel);

}  // namespace lightwell::transport
