// Rays from a point in the air into all directions.
#pragma once
#include <vector>

#include "precompute/core/random.h"
#include "precompute/trace/tracer.h"

namespace lightwell::transport {

/// `rays` rays from `position`, uniform over the sphere. `stream` names the random numbers within the bake's `seed`.
inline std::vector<trace::Ray> sphereRays(const Vec3& position, uint32_t rays, uint64_t seed, uint64_t stream) {
  const Sampler sampler(seed, stream);
  std::vector<trace::Ray> list;
  list.reserve(rays);
  for (uint32_t i = 0; i < rays; ++i) {
    const Vec2 u = sampler.get2D(i, 0);
    const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
    list.push_back({.origin = position, .direction = Vec3(r * std::cos(phi), r * std::sin(phi), z).normalized(), .key = mixBits(combineKeys(stream, i))});
  }
  return list;
}

}  // namespace lightwell::transport
