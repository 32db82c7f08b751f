// The solid angle of a triangle.
#pragma once
#include <cmath>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// In steradians, [0, 2π], of the triangle whose corners lie at `a`, `b` and `c` from the eye, in any unit of length. Van Oosterom, Strackee: "The Solid Angle of a
/// Plane Triangle", equation 8.
inline double triangleSolidAngle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double la = a.length(), lb = b.length(), lc = c.length();
  return 2 * std::atan2(std::abs(a.dot(b.cross(c))), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace lightwell::transport
