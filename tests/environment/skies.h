// Skies that the tests of environment light make for themselves.
#pragma once
#include <functional>
#include <memory>

#include "precompute/core/diagnostics.h"
#include "precompute/transport/environment/environment_map.h"

namespace lightwell::transport {

inline Vec3 directionOf(double theta, double phi) {
  return {float(std::sin(theta) * std::cos(phi)), float(std::cos(theta)), float(std::sin(theta) * std::sin(phi))};
}

/// A map whose texels hold `radiance` at their centres.
inline EnvironmentMap makeSky(int width, int height, const std::function<Rgb(const Vec3&)>& radiance, const MapPlacement& placement = {}) {
  std::vector<Rgb> pixels;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      pixels.push_back(radiance(directionOf((y + 0.5) / height * std::numbers::pi, ((x + 0.5) / width - 0.5) * 2 * std::numbers::pi)));
  return EnvironmentMap(memoryRowSource(width, height, std::move(pixels)), "sky", placement);
}

/// 1 inside of a cap of `radius_rad` about the unit vector `center`, else 0.
inline float inCap(const Vec3& d, const Vec3& center, float radius_rad) {
  return (d - center).length() < 2 * std::sin(radius_rad / 2) ? 1.0f : 0.0f;
}

/// An outdoor sky: a blue gradient above brown ground, a sun 45,000 times the mean, and three lamps of a few degrees.
inline Rgb outdoorRadiance(const Vec3& d) {
  const float up = std::max(0.0f, d.y);
  Rgb radiance = d.y >= 0 ? Rgb(0.4f, 0.6f, 1.0f) * (0.3f + 1.2f * (1 - up) * (1 - up)) : Rgb(0.25f, 0.2f, 0.15f);
  radiance += Rgb(45000, 40000, 30000) * inCap(d, Vec3(0.5f, 0.6f, 0.62f).normalized(), 0.006f);
  radiance += Rgb(40, 20, 5) * inCap(d, Vec3(-1, 0.2f, 0.1f).normalized(), 0.06f);
  radiance += Rgb(10, 30, 60) * inCap(d, Vec3(0.1f, 0.05f, -1).normalized(), 0.1f);
  radiance += Rgb(25, 25, 25) * inCap(d, Vec3(0.3f, 0.9f, -0.2f).normalized(), 0.04f);
  return radiance;
}

inline Vec3 uniformDirection(const Vec2& u) {
  const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z)), phi = 2 * kPi * u.y;
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace lightwell::transport
