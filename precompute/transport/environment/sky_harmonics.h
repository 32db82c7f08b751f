// Real spherical harmonics to order 2 in the project's axes, for light that needs no shadow.
#pragma once
#include <array>
#include <span>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// Orthonormal over the sphere, without the Condon-Shortley phase: Y00; Y1: y, z, x; Y2: xy, yz, 3z² − 1, xz, x² − y².
inline std::array<double, 9> sphericalHarmonics(const Vec3d& d) {
  return {0.28209479177387814,
          0.48860251190291992 * d.y,
          0.48860251190291992 * d.z,
          0.48860251190291992 * d.x,
          1.0925484305920792 * d.x * d.y,
          1.0925484305920792 * d.y * d.z,
          0.31539156525252005 * (3 * d.z * d.z - 1),
          1.0925484305920792 * d.x * d.z,
          0.54627421529603959 * (d.x * d.x - d.y * d.y)};
}

/// Irradiance on a plane with unit `normal` from radiance coefficients: bands scaled by π, 2π/3, π/4 (Ramamoorthi and Hanrahan 2001,
/// equation 8). May be slightly negative opposite a strong light.
inline Rgb irradianceFromHarmonics(std::span<const Rgb, 9> radiance_sh, const Vec3& normal) {
  const std::array<double, 9> y = sphericalHarmonics(Vec3d(normal));
  Rgb sum(0, 0, 0);
  for (size_t i = 0; i < 9; ++i) sum += radiance_sh[i] * float(y[i] * (i == 0 ? kPi : i < 4 ? 2 * kPi / 3 : kPi / 4));
  return sum;
}

}  // namespace lightwell::transport
