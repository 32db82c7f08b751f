#include "precompute/transport/prm/entry_irradiance.h"

namespace lightwell::transport {
namespace {

// Beyond so many times the longer half side, the middle of a rectangle stands for all of it within two parts in a thousand.
constexpr float kFar = 35.0f;

/// Solid angle of the triangle of three directions of any length (Van Oosterom, Strackee: "The Solid Angle of a Plane Triangle", equation 8).
float solidAngle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const float la = a.length(), lb = b.length(), lc = c.length();
  return 2.0f * std::atan2(std::abs(a.dot(b.cross(c))), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

float rectangleGain(const Vec3& to_light, const Vec3& normal, const Vec3& half_u, const Vec3& half_v) {
  const float area = 4.0f * half_u.length() * half_v.length(), reach2 = kFar * kFar * std::max(half_u.length2(), half_v.length2());
  const float distance2 = to_light.length2(), height = to_light.dot(normal);
  if (!(area > 0) || !(distance2 < reach2) || !(height > 0)) return 1.0f;
  const Vec3 a = -half_u - half_v - to_light, b = half_u - half_v - to_light, c = half_u + half_v - to_light, d = half_v - half_u - to_light;
  return (solidAngle(a, b, c) + solidAngle(a, c, d)) * distance2 * std::sqrt(distance2) / (area * height);
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
      rays.push_back({.origin = trace::Tracer::offsetOrigin(entries.position[i], entries.normal[i], to_light), .direction = to_light,
                      .t_max = distance * (1.0f - 1e-4f), .key = i});
      unshadowed.emplace_back(cluster, irradiance_rgb * (gain * entries.weight[i]));
    }
  std::vector<float> visibility(rays.size());
  tracer.transmittance(rays, visibility);
  for (size_t i = 0; i < rays.size(); ++i) result[unshadowed[i].first] += unshadowed[i].second * visibility[i];
  return result;
}

}  // namespace lightwell::transport
