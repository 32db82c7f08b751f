// The internal frame of a scene: re-centred, and scaled by a power of two.
#pragma once
#include <ImathBox.h>

#include "precompute/core/math.h"

namespace lightwell::scene {

/// internal = (world_m − origin_m) / metres_per_unit.
struct Frame {
  Vec3d origin_m{0, 0, 0};
  double metres_per_unit = 1;
  Vec3 toInternal(const Vec3d& world_m) const { return Vec3((world_m - origin_m) / metres_per_unit); }
};

/// The frame in which the largest extent of `bounds_m` lies in [8, 16). Scaling by a power of two keeps every mantissa. The
/// identity for bounds that are empty or a point.
Frame chooseFrame(const Imath::Box3d& bounds_m);

}  // namespace lightwell::scene
