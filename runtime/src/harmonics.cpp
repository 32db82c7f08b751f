#include "runtime/src/harmonics.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace lightwell::runtime {

void harmonics(float x, float y, float z, float* basis) {
  const float values[kHarmonics] = {0.28209479f, 0.48860251f * y, 0.48860251f * z, 0.48860251f * x, 1.09254843f * x * y,
                                    1.09254843f * y * z, 0.31539157f * (3 * z * z - 1), 1.09254843f * x * z, 0.54627422f * (x * x - y * y)};
  std::memcpy(basis, values, sizeof values);
}

namespace {

constexpr float kPi = 3.14159265f;

/// The irradiance of one channel about n: linear · n + quadratic in n + mean.
struct Irradiance {
  float x, y, z, mean, xy, yz, zz, zx, xx_yy;

  explicit Irradiance(const float (*sh)[3], int channel) {
    constexpr float a1 = 0.48860251f * 2 * kPi / 3, a2 = 1.09254843f * kPi / 4;
    x = a1 * sh[3][channel], y = a1 * sh[1][channel], z = a1 * sh[2][channel], mean = 0.28209479f * kPi * sh[0][channel];
    xy = a2 * sh[4][channel], yz = a2 * sh[5][channel], zz = 0.31539157f * kPi / 4 * sh[6][channel], zx = a2 * sh[7][channel], xx_yy = a2 / 2 * sh[8][channel];
  }
  float curvature() const { return std::abs(xy) + std::abs(yz) + 6 * std::abs(zz) + std::abs(zx) + 2 * std::abs(xx_yy); }
  float about(const float* n) const {
    return mean + x * n[0] + y * n[1] + z * n[2] + xy * n[0] * n[1] + yz * n[1] * n[2] + zz * (3 * n[2] * n[2] - 1) + zx * n[0] * n[2] +
           xx_yy * (n[0] * n[0] - n[1] * n[1]);
  }
  /// Over all unit normals, within what a few steps reach.
  float least() const {
    float best[3] = {}, least = INFINITY;
    for (int k = 0; k < 27; ++k) {
      const float n[3] = {float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1)};
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      if (length == 0) continue;
      const float u[3] = {n[0] / length, n[1] / length, n[2] / length}, value = about(u);
      if (value < least) least = value, std::memcpy(best, u, sizeof best);
    }
    // Less the curvature the function is concave: its tangent lies above it, and the least value of the tangent is known.
    const float k = curvature();
    for (int step = 0; step < 8; ++step) {
      const float g[3] = {x + xy * best[1] + zx * best[2] + 2 * xx_yy * best[0], y + xy * best[0] + yz * best[2] - 2 * xx_yy * best[1],
                          z + yz * best[1] + 6 * zz * best[2] + zx * best[0]};
      float n[3], length2 = 0;
      for (int i = 0; i < 3; ++i) n[i] = k * best[i] - g[i], length2 += n[i] * n[i];
      if (!(length2 > 0)) break;
      for (int i = 0; i < 3; ++i) best[i] = n[i] / std::sqrt(length2);
    }
    return std::min(least, about(best));
  }
};

}  // namespace

void keepIrradiancePositive(float (*sh)[3]) {
  for (int c = 0; c < 3; ++c) {
    const Irradiance irradiance(sh, c);
    const float linear = std::sqrt(irradiance.x * irradiance.x + irradiance.y * irradiance.y + irradiance.z * irradiance.z);
    if (linear + irradiance.curvature() <= irradiance.mean) continue;
    const float least = irradiance.least();
    if (least >= 0) continue;
    const float scale = irradiance.mean > 0 ? irradiance.mean / (irradiance.mean - 1.001f * least) : 0.0f;
    for (uint32_t k = 1; k < kHarmonics; ++k) sh[k][c] *= scale;
  }
}

}  // namespace lightwell::runtime
