#include "precompute/transport/lightmap/tilt.h"

#include <algorithm>
#include <cmath>

namespace lightwell::transport {
namespace {

constexpr double kMostTilt = kPi / 4;
constexpr int kTilts = 24, kTurns = 64;  // of the quadrature
constexpr float kLeastCosine = 0.02f;    // light that grazes more than that counts as if it came from here

}  // namespace

TiltKernel::TiltKernel() {
  // Moments of m − n over the cap of tilted normals, and of what light from one direction gives to them; by symmetry only two are not zero.
  for (int step = 0; step <= kSteps; ++step) {
    const double z = double(step) / kSteps, across = std::sqrt(1 - z * z);
    double square_across = 0, square_along = 0, light_across = 0, light_along = 0;
    for (int i = 0; i < kTilts; ++i) {
      const double cosine = 1 - (1 - std::cos(kMostTilt)) * (i + 0.5) / kTilts, sine = std::sqrt(1 - cosine * cosine);
      for (int k = 0; k < kTurns; ++k) {
        const double x = sine * std::cos(2 * double(kPi) * (k + 0.5) / kTurns);
        const double change = std::max(0.0, x * across + cosine * z) - z;
        square_across += x * x, square_along += (cosine - 1) * (cosine - 1);
        light_across += x * change, light_along += (cosine - 1) * change;
      }
    }
    along_[size_t(step)] = {float(light_across / square_across), float(light_along / square_along)};
  }
}

Vec3 TiltKernel::gradient(const Vec3& normal, const Vec3& to_light) const {
  const float cosine = std::min(1.0f, normal.dot(to_light));
  if (!(cosine > 0.0f)) return Vec3(0.0f);
  const float place = cosine * kSteps;
  const size_t step = std::min<size_t>(size_t(place), kSteps - 1);
  const Vec2 amount = along_[step] * (1 - (place - float(step))) + along_[step + 1] * (place - float(step));
  Vec3 across = to_light - normal * cosine;
  const float sine = across.length();
  across = sine > 0.0f ? across / sine : Vec3(0.0f);
  return (across * amount.x + normal * amount.y) / std::max(cosine, kLeastCosine);
}

}  // namespace lightwell::transport
