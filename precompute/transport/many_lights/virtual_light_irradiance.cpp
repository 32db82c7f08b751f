#include "precompute/transport/many_lights/virtual_light_irradiance.h"

#include <algorithm>
#include <cmath>

#include "precompute/core/random.h"
#include "precompute/transport/lambert.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kShadowStream = 15ull << 40;
constexpr uint32_t kMostLookedAt = 4096, kRays = 4096;       // of a slot
constexpr uint32_t kFewestPoints = 4, kMostPoints = 16;      // likewise
enum Dimension : uint32_t { kOffset = 0, kPiece = 1, kPlace = 2, kLight = 16 };

double areaOf(const VirtualLight& light) {
  if (light.type != VirtualLightType::polygon) return double(kPi) * double(light.radius) * double(light.radius);
  Vec3d twice(0.0);
  const Vec3d origin(light.vertices.at(0));
  for (size_t i = 2; i < light.vertices.size(); ++i) twice += (Vec3d(light.vertices[i - 1]) - origin).cross(Vec3d(light.vertices[i]) - origin);
  return twice.length() / 2;
}

/// Integral of the clamped cosine to a normal over a cone of directions: Lagarde, de Rousiers, "Moving Frostbite to Physically Based Rendering" (2014), listing 10, after Snyder 1996. `cosine` is that
/// of the cone's axis, `sine` that of its half angle, at most that of a half sphere.
double coneIrradiance(double cosine, double sine) {
  cosine = std::clamp(cosine, -1.0, 1.0);
  const double sine2 = sine * sine, pi = double(kPi);
  if (cosine * cosine >= sine2) return pi * sine2 * std::max(cosine, 0.0);
  const double normal_sine = std::sqrt(std::max(1 - cosine * cosine, 1e-12)), x = std::sqrt(std::max(1 / sine2 - 1, 0.0));
  const double y = std::clamp(-x * cosine / normal_sine, -1.0, 1.0), height = normal_sine * std::sqrt(1 - y * y);
  return std::max(0.0, (cosine * std::acos(y) - x * height) * sine2 + std::atan2(height, x));
}

double luminous(const VirtualLight& light) { return double(luminance(light.power_rgb)); }

}  // namespace

double irradianceShare(const VirtualLight& light, const Vec3& position, const Vec3& normal) {
  const Vec3d to_light = Vec3d(light.position) - Vec3d(position), up(normal), front(light.normal);
  const double distance2 = to_light.length2(), distance = std::sqrt(distance2), pi = double(kPi);
  const Vec3d direction = distance > 0 ? to_light / distance : up;
  const double received = std::max(direction.dot(up), 0.0), sent = std::max(-direction.dot(front), 0.0);
  switch (light.type) {
    case VirtualLightType::point:
      return received * sent / std::max(pi * distance2, 1e-30);
    case VirtualLightType::disk:
      return received * sent / std::max(pi * distance2 + areaOf(light), 1e-30);
    case VirtualLightType::sphere: {
      const double sine = distance > double(light.radius) ? double(light.radius) / distance : 1;
      if (sine < 1e-3) return received * sent / std::max(pi * distance2, 1e-30);
      const double solid_angle = 2 * pi * (sine * sine / (1 + std::sqrt(std::max(1 - sine * sine, 0.0))));
      return coneIrradiance(direction.dot(up), sine) * coneIrradiance(-direction.dot(front), sine) / solid_angle / std::max(pi * areaOf(light), 1e-30);
    }
    case VirtualLightType::polygon:
      break;
  }
  if (!(front.dot(to_light) < 0)) return 0;  // from behind
  std::array<Vec3d, kMostLambertCorners> corners;
  const size_t count = std::min(light.vertices.size(), corners.size());
  for (size_t i = 0; i < count; ++i) corners[i] = Vec3d(light.vertices[i]) - Vec3d(position);
  return polygonIrradiance(std::span(corners).first(count), up) / pi / std::max(areaOf(light), 1e-30);
}

Vec3 pointOnLight(const VirtualLight& light, const Vec2& u) {
  if (light.type == VirtualLightType::point) return light.position;
  if (light.type != VirtualLightType::polygon) {
    Vec3 tangent, bitangent;
    orthonormalBasis(light.normal, tangent, bitangent);
    const float radius = light.radius * std::sqrt(u.x), angle = 2 * kPi * u.y;
    return light.position + tangent * (radius * std::cos(angle)) + bitangent * (radius * std::sin(angle));
  }
  // A fan from the first corner: the triangle by its share of the area, with u.x used again inside of it.
  const auto& v = light.vertices;
  const auto twiceArea = [&](size_t i) { return (v[i - 1] - v[0]).cross(v[i] - v[0]).length(); };
  float total = 0;
  for (size_t i = 2; i < v.size(); ++i) total += twiceArea(i);
  float rest = u.x * total;
  size_t i = 2;
  for (; i + 1 < v.size() && rest >= twiceArea(i); ++i) rest -= twiceArea(i);
  const Vec2 place = sampleTriangle({std::clamp(rest / std::max(twiceArea(i), 1e-30f), 0.0f, 1.0f), u.y});
  return v[0] + (v[i - 1] - v[0]) * place.x + (v[i] - v[0]) * place.y;
}

VirtualLightSampler::VirtualLightSampler(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, std::span<const VirtualLight> lights)
    : scene_(scene), atlas_(atlas), tracer_(tracer), lights_(lights) {
  double power = 0, area = 0;
  for (const VirtualLight& light : lights) cumulative_power_.push_back(power += luminous(light));
  for (const atlas::Slot& slot : atlas.slots) area += double(slot.area);
  if (area > 0) most_share_ = double(lights.size()) / area;
  looked_at_ = std::min(uint32_t(lights.size()), kMostLookedAt);
  points_ = std::clamp(kRays / std::max(looked_at_, 1u), kFewestPoints, kMostPoints);
}

std::vector<VirtualLightSampler::Chosen> VirtualLightSampler::choose(float offset) const {
  std::vector<Chosen> chosen;
  if (looked_at_ == lights_.size()) {
    for (uint32_t i = 0; i < lights_.size(); ++i) chosen.push_back({i, 1.0});
    return chosen;
  }
  const double step = cumulative_power_.back() / looked_at_;
  double next = double(offset) * step;
  for (uint32_t i = 0; i < lights_.size(); ++i) {
    double times = 0;
    for (; next < cumulative_power_[i]; next += step) ++times;
    if (times > 0) chosen.push_back({i, times * step / luminous(lights_[i])});
  }
  return chosen;
}

Vec3d VirtualLightSampler::lightOf(const Chosen& chosen, std::span<const atlas::SurfacePoint> at, uint64_t key) const {
  const VirtualLight& light = lights_[chosen.light];
  const Sampler sampler(key, kShadowStream + chosen.light);
  double exact = 0, expected = 0, seen = 0;
  std::array<trace::Ray, kMostPoints> rays;
  std::array<double, kMostPoints> weight;
  std::array<float, kMostPoints> transmittance;
  size_t count = 0;
  for (uint32_t i = 0; i < at.size(); ++i) {
    double share = irradianceShare(light, at[i].position, at[i].normal);
    if (light.type == VirtualLightType::point && most_share_ > 0) share = std::min(share, most_share_);
    if (!(share > 0)) continue;
    exact += share;
    const Vec3 target = pointOnLight(light, sampler.get2D(i, kLight)), offset = target - at[i].position;
    const float distance2 = offset.length2();
    if (!(distance2 > 0)) continue;
    const Vec3 direction = offset / std::sqrt(distance2);
    // A sphere's points count by distance alone: its light comes from all around it.
    const float sent = light.type == VirtualLightType::sphere ? 1.0f : std::max(-direction.dot(light.normal), 0.0f);
    const double of_ray = double(std::max(direction.dot(at[i].normal), 0.0f)) * double(sent) / double(distance2);
    expected += of_ray;
    if (!(of_ray > 0) || !(direction.dot(at[i].geometric_normal) > 0)) continue;
    const Vec3 origin = trace::Tracer::offsetOrigin(at[i].position, at[i].geometric_normal, direction);
    const Vec3 end = trace::Tracer::offsetOrigin(target, light.normal, -direction);
    rays[count] = {.origin = origin, .direction = end - origin, .t_max = 1.0f - 1e-4f, .key = mixBits(combineKeys(combineKeys(key, chosen.light), i))};
    weight[count++] = of_ray;
  }
  if (!(expected > 0)) return Vec3d(0.0);
  tracer_.transmittance(std::span(rays).first(count), std::span(transmittance).first(count));
  for (size_t i = 0; i < count; ++i) seen += weight[i] * double(transmittance[i]);
  return Vec3d(light.power_rgb) * (chosen.weight * exact / double(at.size()) * (seen / expected));
}

std::vector<Rgb> VirtualLightSampler::irradiance(std::span<const uint32_t> slots, uint64_t seed, const CancelFlag& cancel) const {
  std::vector<Rgb> irradiance_rgb;
  std::vector<atlas::SurfacePoint> at;
  for (const uint32_t index : slots) {
    cancel.check();
    const atlas::Slot& slot = atlas_.slots[index];
    const uint64_t key = combineKeys(seed, slot.texel);
    const Sampler sampler(key, kShadowStream);
    at.clear();
    for (uint32_t i = 0; i < points_; ++i) at.push_back(atlas::sampleSlot(scene_.mesh, atlas_, slot, sampler.get1D(i, kPiece), sampler.get2D(i, kPlace)));
    Vec3d sum(0.0);
    for (const Chosen& chosen : choose(sampler.get1D(0, kOffset))) sum += lightOf(chosen, at, key);
    irradiance_rgb.emplace_back(sum);
  }
  return irradiance_rgb;
}

}  // namespace lightwell::transport
