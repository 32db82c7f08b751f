#include "precompute/scene/normalization.h"

#include <algorithm>
#include <cmath>

namespace lightwell::scene {

Frame chooseFrame(const Imath::Box3d& bounds_m) {
  Frame frame;
  if (bounds_m.isEmpty()) return frame;
  const Vec3d size = bounds_m.size();
  const double extent = std::max({size.x, size.y, size.z});
  if (!(extent > 0)) return frame;
  int exponent;
  std::frexp(extent, &exponent);  // extent = m * 2^exponent with m in [1/2, 1)
  frame.origin_m = bounds_m.center();
  frame.metres_per_unit = std::ldexp(1.0, exponent - 4);
  if (float(extent / 2 / frame.metres_per_unit) >= 8) frame.metres_per_unit *= 2;  // would be rounded up to 16
  return frame;
}

}  // namespace lightwell::scene
