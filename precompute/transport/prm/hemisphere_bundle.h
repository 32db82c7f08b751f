// Directions over a hemisphere that many texels can share.
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// Low-discrepancy unit directions about +z with density cos / pi, in an order in which neighbours go almost the same way: along a Z-order curve over the square that is mapped
/// to them. Turned about z they are as good: texels turn them each by its own angle.
struct HemisphereBundle {
  /// `owner` names the random numbers within the bake's `seed`.
  HemisphereBundle(uint32_t count, uint64_t seed, uint64_t owner);
  std::vector<Vec3> directions;
};

}  // namespace lightwell::transport
