// Vectors, colours and the few constants that every precompute module shares.
#pragma once
#include <ImathBox.h>
#include <ImathMatrix.h>
#include <ImathVec.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace lightwell {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
using Vec3d = Imath::V3d;
using Box3 = Imath::Box3f;
/// Linear Rec. 709. The variable's name says which quantity it carries (radiance_rgb, irradiance_rgb, albedo_rgb).
using Rgb = Imath::V3f;

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

/// Rec. 709 luminance of a linear colour.
inline float luminance(const Rgb& c) { return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z; }
inline float maxComponent(const Rgb& c) { return c.x > c.y ? (c.x > c.z ? c.x : c.z) : (c.y > c.z ? c.y : c.z); }
inline bool isFinite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// Two unit vectors that complete the unit vector `n` to a right-handed orthonormal frame.
/// Duff et al., "Building an Orthonormal Basis, Revisited" (JCGT 2017): no branch on a pole, stable for every n.
inline void orthonormalBasis(const Vec3& n, Vec3& tangent, Vec3& bitangent) {
  const float sign = std::copysign(1.0f, n.z);
  const float a = -1.0f / (sign + n.z);
  const float b = n.x * n.y * a;
  tangent = Vec3(1.0f + sign * n.x * n.x * a, sign * b, -sign * n.x);
  bitangent = Vec3(b, sign + n.y * n.y * a, -n.y);
}

}  // namespace lightwell
