#include "samples/scenes/procedural_sky.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "stb_image_write.h"

namespace lightwell::samples {
namespace {

constexpr double kPi = std::numbers::pi, kSunRadius = 0.00465;  // rad
constexpr int kParts = 24;                                       // of a texel along its side, where the sun's edge crosses it

/// Luminance relative to something: gradation times indicatrix, table 1 of the standard, type 12.
double clearSky(double cos_zenith, double cos_sun) {
  const double a = -1, b = -0.32, c = 10, d = -3, e = 0.45, gamma = std::acos(std::clamp(cos_sun, -1.0, 1.0));
  return (1 + a * std::exp(b / std::max(cos_zenith, 0.01))) * (1 + c * (std::exp(d * gamma) - std::exp(d * kPi / 2)) + e * cos_sun * cos_sun);
}

Vec3d directionAt(double x, double y, int width, int height) {
  const double theta = y / height * kPi, phi = (x / width - 0.5) * 2 * kPi;
  return {std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
}

}  // namespace

SkyMap makeClearSky(const Vec3& sun_direction, int width, int height) {
  SkyMap map{width, height, std::vector<Rgb>(size_t(width) * size_t(height), Rgb(0))};
  const Vec3d sun(sun_direction);
  const double zenith = clearSky(1, sun.y);
  Vec3d sky_irradiance(0);
  for (int y = 0; y < height / 2; ++y)
    for (int x = 0; x < width; ++x) {
      const Vec3d d = directionAt(x + 0.5, y + 0.5, width, height);
      const double relative = clearSky(d.y, d.dot(sun)) / zenith;
      // Blue overhead, white near the horizon and about the sun.
      const double whiteness = std::clamp(std::exp(-4 * d.y) + 0.5 * std::exp(-5 * std::acos(std::min(1.0, d.dot(sun)))), 0.0, 1.0);
      const Vec3d color = Vec3d(0.45, 0.75, 1.35) * (1 - whiteness) + Vec3d(1.05, 1.0, 0.92) * whiteness;
      map.radiance_rgb[size_t(y) * size_t(width) + size_t(x)] = Rgb(color * relative);
      sky_irradiance += color * (relative * d.y * std::sin((y + 0.5) / height * kPi) * kPi / height * 2 * kPi / width);
    }
  const Vec3d sun_radiance = Vec3d(1.08, 1.0, 0.86) * (4 * (sky_irradiance.x + sky_irradiance.y + sky_irradiance.z) / 3) /
                             (sun.y * kPi * kSunRadius * kSunRadius);
  const double cos_sun_radius = std::cos(kSunRadius), cos_reach = std::cos(kSunRadius + 2 * kPi / width);
  const Rgb ground(Rgb((sky_irradiance + sun_radiance * (sun.y * kPi * kSunRadius * kSunRadius)) * (0.2 / kPi)));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Rgb& radiance = map.radiance_rgb[size_t(y) * size_t(width) + size_t(x)];
      if (y >= height / 2) radiance = ground;
      if (directionAt(x + 0.5, y + 0.5, width, height).dot(sun) < cos_reach) continue;
      int covered = 0;
      for (int part = 0; part < kParts * kParts; ++part)
        covered += directionAt(x + (part % kParts + 0.5) / kParts, y + (part / kParts + 0.5) / kParts, width, height).dot(sun) > cos_sun_radius;
      radiance += Rgb(sun_radiance * (covered / double(kParts * kParts)));
    }
  return map;
}

std::vector<uint8_t> encodeHdr(const SkyMap& map) {
  std::vector<uint8_t> bytes;
  const auto append = [](void* context, void* data, int size) {
    auto& to = *static_cast<std::vector<uint8_t>*>(context);
    to.insert(to.end(), static_cast<uint8_t*>(data), static_cast<uint8_t*>(data) + size);
  };
  stbi_write_hdr_to_func(append, &bytes, map.width, map.height, 3, &map.radiance_rgb[0].x);
  return bytes;
}

}  // namespace lightwell::samples
