// Real spherical harmonics to band 2, as lw_environment_info has them: orthonormal, Y00; y, z, x; xy, yz, 3zz − 1, xz, xx − yy, positive factors.
#pragma once
#include <array>

#include "precompute/core/math.h"

namespace lightwell::transport {

inline constexpr int kHarmonics = 9;

inline std::array<float, kHarmonics> sphericalHarmonics(const Vec3& d) {
  return {0.28209479f,
          0.48860251f * d.y, 0.48860251f * d.z, 0.48860251f * d.x,
          1.09254843f * d.x * d.y, 1.09254843f * d.y * d.z, 0.31539157f * (3 * d.z * d.z - 1), 1.09254843f * d.x * d.z,
          0.54627422f * (d.x * d.x - d.y * d.y)};
}

/// What a clamped cosine leaves of the bands (Ramamoorthi, Hanrahan: "An Efficient Representation for Irradiance Environment Maps", 2001, equation 8).
inline constexpr std::array<float, kHarmonics> kCosineBand = {kPi,     2 * kPi / 3, 2 * kPi / 3, 2 * kPi / 3, kPi / 4, kPi / 4, kPi / 4, kPi / 4, kPi / 4};

}  // namespace lightwell::transport
