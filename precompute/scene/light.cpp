// KHR_lights_punctual: what a light gives to a surface, and its internal units.
#include <algorithm>
#include <cmath>

#include "precompute/scene/import.h"
#include "precompute/scene/scene.h"

namespace lightwell::scene {
namespace {

/// Closer than this the inverse square would leave the range of a float.
constexpr float kMinDistance = 1e-6f;
constexpr float kMaxIrradiance = 1e30f;

/// The recommended angular attenuation of the extension, with its lightAngleScale and lightAngleOffset.
float spotAttenuation(const Light& light, const Vec3& to_light) {
  const float cos_outer = std::cos(light.outer_cone_angle);
  const float scale = 1.0f / std::max(0.001f, std::cos(light.inner_cone_angle) - cos_outer);
  const float attenuation = std::clamp((-light.direction.dot(to_light) - cos_outer) * scale, 0.0f, 1.0f);
  return attenuation * attenuation;
}

/// The recommended window of the extension: 1 at the light, 0 from `range` on.
float rangeAttenuation(const Light& light, float distance) {
  if (light.range <= 0) return 1;
  const float ratio = distance / light.range;
  return std::clamp(1.0f - ratio * ratio * ratio * ratio, 0.0f, 1.0f);
}

}  // namespace

Rgb lightIrradiance(const Light& light, const Vec3& position, const Vec3& normal, Vec3& to_light, float& distance) {
  float attenuation = 1;
  if (light.type == LightType::directional) {
    to_light = -light.direction;
    distance = std::numeric_limits<float>::infinity();
  } else {
    const Vec3 offset = light.position - position;
    distance = offset.length();
    to_light = distance > 0 ? offset / distance : normal;
    attenuation = rangeAttenuation(light, distance);
    if (light.type == LightType::spot) attenuation *= spotAttenuation(light, to_light);
    const float clamped = std::max(distance, kMinDistance);
    attenuation /= clamped * clamped;
  }
  const float cosine = normal.dot(to_light);
  if (!(cosine > 0) || !(attenuation > 0)) return Rgb(0);
  Rgb irradiance_rgb;
  for (int c = 0; c < 3; ++c) irradiance_rgb[c] = std::min(light.intensity[c] * (attenuation * cosine), kMaxIrradiance);
  return irradiance_rgb;
}

Light toInternal(const Scene& scene, const Light& world_light, const Vec3d& position_m) {
  Light light = world_light;
  const double unit = scene.metres_per_unit;
  light.position = Vec3((position_m - scene.origin_m) / unit);
  light.range = float(world_light.range / unit);
  if (light.type != LightType::directional)
    for (int c = 0; c < 3; ++c) light.intensity[c] = float(double(world_light.intensity[c]) / (unit * unit));
  return light;
}

}  // namespace lightwell::scene
