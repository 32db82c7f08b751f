#include "precompute/transport/prm/entry_irradiance.h"

#include "precompute/transport/solid_angle.h"

namespace lightwell::transport {
namespace {

// Beyond so many times the longer half side, the middle of a rectangle stands for all of it within two parts in a thousand.
constexpr float kFar = 35.0f;

}  // namespace

float rectangleGain(const Vec3& to_light, const Vec3& normal, const Vec3& half_u, const Vec3& half_v) {
  const float area = 4.0f * half_u.length() * half_v.length(), reach2 = kFar * kFar * std::max(half_u.length2(), half_v.length2());
  const float distance2 = to_light.length2(), height = to_light.dot(normal);
  if (!(area > 0) || !(distance2 < reach2) || !(height > 0)) return 1.0f;
  const Vec3d a(-half_u - half_v - to_light), b(half_u - half_v - to_light), c(half_u + half_v - to_light), d(half_v - half_u - to_light);
  return float((triangleSolidAngle(a, b, c) + triangleSolidAngle(a, c, d)) * distance2 * std::sqrt(distance2) / (area * height));
}

std::vector<Rgb> clusterIrradiance(const PrmEntries& entries, const trace::Tracer& tracer, const scene::Light& light) {
  std::vector<Rgb> result(entries.clusterCount(), Rgb(0.0f));
  std::vector<trace::Ray> rays;
  std::vector<std::pair<uint32_t, Rgb>> unshadowed;  // cluster, weighted irradiance
  for (uint32_t cluster = 0; cluster < entries.clusterCount(); ++cluster)
    for (uint32_t i = entries.cluster_first_entry[cluster]; i < entries.cluster_first_entry[cluster + 1]; ++i) {
      Vec3 to_light;
      float distance;
      const Rgb irradiance_rgb = scene::lightIrradiance(light, entries.position[i], entries.normal[i], to_light, distance);
      if (maxComponent(irradiance_rgb) <= 0.0f) continue;
      const float gain = light.type == scene::LightType::directional
                             ? 1.0f
                             : rectangleGain(light.position - entries.position[i], entries.normal[i], entries.half_u[i], entries.half_v[i]);
      rays.push_back(shadowRay(entries, i, to_light, distance));
      unshadowed.emplace_back(cluster, irradiance_rgb * (gain * entries.weight[i]));
    }
  std::vector<float> visibility(rays.size());
  tracer.transmittance(rays, visibility);
  for (size_t i = 0; i < rays.size(); ++i) result[unshadowed[i].first] += unshadowed[i].second * visibility[i];
  return result;
}

}  // namespace lightwell::transport
