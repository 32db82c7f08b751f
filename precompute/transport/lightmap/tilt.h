// How irradiance changes when the normal is tilted, as normal maps tilt it: to first order, fitted over tilts of up to 45 degrees.
//
// E(m) ≈ E(n) × max(0, 1 + g · (m − n)) for a unit normal m near the surface's n, in the manner of the rotational gradient (Ward, Heckbert, "Irradiance Gradients", 1992). Where all light
// stays above the horizons of n and m this is exact, with g = ∫ L ω dω / E; light near the horizon, of which a tilted surface loses some and gains none, enters by least squares.
#pragma once
#include <array>

#include "precompute/core/math.h"

namespace lightwell::transport {

class TiltKernel {
 public:
  TiltKernel();

  /// g of light from the direction `to_light` alone, about the unit normal `normal`; zero for light from below. Of several lights g is the mean, weighted by what they give.
  Vec3 gradient(const Vec3& normal, const Vec3& to_light) const;

 private:
  static constexpr int kSteps = 64;
  std::array<Vec2, kSteps + 1> along_{};  // by the cosine to the normal: g across the normal, g along it, both times the cosine
};

}  // namespace lightwell::transport
