// How normals follow an affine transform.
#pragma once
#include <ImathMatrix.h>

#include <cmath>

#include "precompute/core/math.h"

namespace lightwell::scene {

/// The cofactors of the linear part: the inverse transpose times the determinant, which exists even when there is no inverse. Its sign
/// is that of the inverse transpose, so that normals stay on the front once the winding of mirrored triangles is turned.
class NormalTransform {
 public:
  explicit NormalTransform(const Imath::M44d& m) {
    const Vec3d x(m[0][0], m[0][1], m[0][2]), y(m[1][0], m[1][1], m[1][2]), z(m[2][0], m[2][1], m[2][2]);
    row_[0] = y.cross(z);
    row_[1] = z.cross(x);
    row_[2] = x.cross(y);
    mirrored_ = x.dot(row_[0]) < 0;
  }
  /// Whether the transform turns counter-clockwise triangles clockwise.
  bool mirrored() const { return mirrored_; }
  /// Unit, or zero when the transform flattens the direction.
  Vec3 apply(const Vec3& normal) const {
    const Vec3d result = double(normal.x) * row_[0] + double(normal.y) * row_[1] + double(normal.z) * row_[2];
    const double length = result.length();
    if (!(length > 0) || !std::isfinite(length)) return Vec3(0);
    return Vec3(result * ((mirrored_ ? -1.0 : 1.0) / length));
  }

 private:
  Vec3d row_[3];
  bool mirrored_;
};

}  // namespace lightwell::scene
