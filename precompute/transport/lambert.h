// Lambert's formula: what a polygon that shines evenly gives to a point.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "precompute/core/math.h"

namespace lightwell::transport {

inline constexpr size_t kMostLambertCorners = 8;

/// Irradiance by a convex, planar polygon of radiance 1 when nothing is in the way, of the part above the horizon of the unit normal `up`. In [0, π]. `corners`: 3 to kMostLambertCorners,
/// relative to the point; of either winding.
inline double polygonIrradiance(std::span<const Vec3d> corners, const Vec3d& up) {
  std::array<Vec3d, kMostLambertCorners + 1> above;
  size_t count = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3d &a = corners[i], &b = corners[(i + 1) % corners.size()];
    const double za = a.dot(up), zb = b.dot(up);
    if (za >= 0 && count < above.size()) above[count++] = a;
    if ((za < 0) != (zb < 0) && count < above.size()) above[count++] = a + (b - a) * (za / (za - zb));
  }
  if (count < 3) return 0;
  double sum = 0;
  for (size_t i = 0; i < count; ++i) {
    const Vec3d &a = above[i], &b = above[(i + 1) % count];
    const Vec3d cross = a.cross(b);
    const double length = cross.length();
    if (length > 0) sum += std::atan2(length, a.dot(b)) * (cross.dot(up) / length);
  }
  return std::clamp(std::abs(sum) / 2, 0.0, double(kPi));
}

}  // namespace lightwell::transport
