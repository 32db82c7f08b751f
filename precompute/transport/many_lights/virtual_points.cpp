#include "precompute/transport/many_lights/virtual_points.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "precompute/core/random.h"
#include "precompute/transport/mean_albedo.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kPathStream = 12ull << 40;
// Bounds the work when surfaces are nearly white: reflections of all paths together, for each path that was asked for, and of a single one.
constexpr double kMostReflections = 32;
constexpr uint32_t kMostBounces = 16384;
constexpr uint32_t kPilotPaths = 128;  // of a source that may miss; at most so many paths for one that is reflected
/// Light that meets a surface at a grazing angle to its triangle but not to its interpolated normal counts more there, up to this factor.
constexpr float kMostNormalGain = 16;
// Of a coordinate: where float numbers end, and a thousandth of what a lamp may be away from a wall in a room.
constexpr float kPlaneRounding = 0x1p-22f;
enum Dimension : uint32_t { kStart = 0, kDirection = 1, kPick = 2, kSide = 3, kPatch = 4, kFirstBounce = 8, kPerBounce = 2 };

Vec3 about(const Vec3& axis, const Vec3& local) {
  Vec3 tangent, bitangent;
  orthonormalBasis(axis, tangent, bitangent);
  return tangent * local.x + bitangent * local.y + axis * local.z;
}

/// The cosines that bound a spot light's smooth edge, as scene::lightIrradiance has them: falloff = ((cos - outer) / width)², at most 1.
struct SpotEdge {
  float outer, width;
  explicit SpotEdge(const scene::Light& light)
      : outer(std::cos(light.outer_cone_angle)), width(std::max(0.001f, std::cos(light.inner_cone_angle) - outer)) {}
  /// Integral of the falloff over cosines up to 1, in its two parts.
  float edge() const { return std::min(1.0f, std::pow((1 - outer) / width, 3.0f)) * width / 3; }
  float inside() const { return std::max(0.0f, 1 - outer - width); }
  /// A cosine with density proportional to the falloff.
  float cosine(float u) const {
    const float at = u * (edge() + inside());
    return at < edge() ? outer + std::cbrt(3 * at * width * width) : std::min(1.0f, outer + width + (at - edge()));
  }
};

Rgb lampPower(const scene::Light& light, float scene_radius) {
  switch (light.type) {
    case scene::LightType::point:
      return light.intensity * (4 * kPi);
    case scene::LightType::spot: {
      const SpotEdge spot(light);
      return light.intensity * (2 * kPi * (spot.edge() + spot.inside()));
    }
    case scene::LightType::directional:
      return light.intensity * (kPi * scene_radius * scene_radius);
  }
  return Rgb(0.0f);
}

float rangeWindow(const scene::Light& light, float distance) {
  if (!(light.range > 0) || light.type == scene::LightType::directional) return 1;
  const float ratio = distance / light.range;
  return std::clamp(1 - ratio * ratio * ratio * ratio, 0.0f, 1.0f);
}

}  // namespace

struct LightPaths::Start {
  trace::Ray ray;
  Rgb power_rgb{0.0f};
  bool has_point = false;  // on an emitter
  VirtualPoint point{};
};

LightPaths::LightPaths(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer,
                       const std::vector<scene::Light>& lights, const SkyLight* sky, const LightPathOptions& options)
    : scene_(scene), atlas_(atlas), tracer_(tracer), lights_(lights), sky_(sky && !sky->isBlack() ? sky : nullptr), seed_(options.seed),
      most_bounces_(options.bounces ? std::min(options.bounces, kMostBounces) : kMostBounces) {
  if (scene.bounds.isEmpty()) return;
  middle_ = scene.bounds.center();
  radius_ = 0.5f * scene.bounds.size().length() * 1.001f;
  double emitted = 0;
  for (uint32_t slot = 0; slot < atlas.slots.size(); ++slot) {
    const atlas::Slot& s = atlas.slots[slot];
    const double flux = double(kPi) * double(luminance(s.emitted_radiance_rgb)) * double(s.area) * (s.double_sided ? 2 : 1);
    if (!(flux > 0)) continue;
    emitting_slot_.push_back(slot);
    emitting_cdf_.push_back(emitted += flux);
  }
  std::vector<double> power;
  for (const scene::Light& light : lights) power.push_back(double(luminance(lampPower(light, radius_))));
  power.push_back(emitted);
  // What comes through a disk as large as the scene: directions are picked by luminance, so that any of them tells the integral.
  if (sky_) {
    const SkyLight::Sample any = sky_->sample(Vec2(0.5f));
    power.push_back(double(luminance(any.radiance_rgb)) / double(any.pdf_solid_angle) * double(kPi) * double(radius_) * double(radius_));
  }
  // Much of what comes from far away may miss or meet backs: what counts is what is reflected, and more paths make up for those that are lost.
  std::vector<double> share(power.size(), 1.0);
  double total = 0;
  for (uint32_t i = 0; i < power.size(); ++i) {
    if (power[i] > 0 && (i > lights.size() || (i < lights.size() && lights[i].type == scene::LightType::directional))) share[i] = reflectedShare(i);
    total += power[i] *= share[i];
  }
  if (!(total > 0) || !std::isfinite(total)) return;
  const double reflections = 1 / (1 - meanAlbedo(atlas));
  const double paths = std::max(std::min(double(options.paths), options.paths * kMostReflections / reflections), 64.0);
  uint32_t end = 0;
  for (uint32_t i = 0; i < power.size(); ++i) {
    if (!(power[i] > 0)) continue;
    Source source{.index = i, .first_path = end};
    const uint32_t count = std::max(uint32_t(std::lround(paths * power[i] / total / share[i])), 16u);
    end = source.end_path = end + count;
    if (i < lights.size()) source.path_power_rgb = lampPower(lights[i], radius_) / float(count);
    sources_.push_back(source);
  }
}

double LightPaths::reflectedShare(uint32_t index) const {
  const Source source{.index = index, .first_path = 0, .end_path = kPilotPaths, .path_power_rgb = Rgb(1.0f)};
  uint32_t reflected = 0;
  std::vector<VirtualPoint> points;
  for (uint32_t path = 0; path < kPilotPaths; ++path) {
    points.clear();
    tracePath(source, path, points);
    reflected += points.empty() ? 0 : 1;
  }
  return std::max(reflected, 1u) / double(kPilotPaths);
}

LightPaths::Start LightPaths::startOfSky(const Source& source, const Vec2& place, const Vec2& direction) const {
  const SkyLight::Sample from = sky_->sample(direction);
  const Vec3 on_disk = sampleCosineHemisphere(place);  // its x and y are even on the disk
  Start start;
  start.power_rgb = from.radiance_rgb * (kPi * radius_ * radius_ / from.pdf_solid_angle / float(source.end_path - source.first_path));
  start.ray.direction = -from.direction;
  start.ray.origin = middle_ + about(from.direction, Vec3(on_disk.x, on_disk.y, 0)) * radius_ + from.direction * radius_;
  return start;
}

LightPaths::Start LightPaths::startOfLamp(const Source& source, const Vec2& place, const Vec2& direction) const {
  const scene::Light& light = lights_[source.index];
  Start start;
  start.power_rgb = source.path_power_rgb;
  if (light.type == scene::LightType::directional) {
    // The point below the concentric map's direction is even on the disk.
    const Vec3 on_disk = sampleCosineHemisphere(place);
    start.ray.direction = light.direction;
    start.ray.origin = middle_ + about(light.direction, Vec3(on_disk.x, on_disk.y, 0)) * radius_ - light.direction * radius_;
    return start;
  }
  const bool spot = light.type == scene::LightType::spot;
  const float cosine = spot ? SpotEdge(light).cosine(direction.x) : 1 - 2 * direction.x;
  const float sine = std::sqrt(std::max(0.0f, 1 - cosine * cosine)), angle = 2 * kPi * direction.y;
  const Vec3 local(sine * std::cos(angle), sine * std::sin(angle), cosine);
  start.ray.origin = light.position;
  start.ray.direction = (spot ? about(light.direction, local) : local).normalized();
  // A surface in whose very plane a lamp is does not hide from it what is in front: its rays begin behind the rounding of their origin.
  start.ray.t_min = kPlaneRounding * std::max({std::abs(light.position.x), std::abs(light.position.y), std::abs(light.position.z), 1.0f});
  return start;
}

LightPaths::Start LightPaths::startOnEmitter(const Source& source, float pick, float side, float patch, const Vec2& place,
                                             const Vec2& direction) const {
  const double target = double(pick) * emitting_cdf_.back();
  const size_t i = std::min<size_t>(size_t(std::upper_bound(emitting_cdf_.begin(), emitting_cdf_.end(), target) - emitting_cdf_.begin()),
                                    emitting_cdf_.size() - 1);
  const atlas::Slot& slot = atlas_.slots[emitting_slot_[i]];
  const double probability = (emitting_cdf_[i] - (i ? emitting_cdf_[i - 1] : 0.0)) / emitting_cdf_.back();
  const atlas::SurfacePoint at = atlas::sampleSlot(scene_.mesh, atlas_, slot, patch, place);
  const bool double_sided = scene_.materials[scene_.mesh.triangle_material[at.triangle]].double_sided;
  const scene::SurfaceColor color = scene::surfaceColor(scene_, at.triangle, at.u, at.v);
  Start start;
  const double weight =
      double(kPi) * double(slot.area) * (double_sided ? 2 : 1) / (probability * double(source.end_path - source.first_path));
  start.power_rgb = Rgb(Vec3d(color.emitted_radiance_rgb * color.alpha) * weight);
  start.has_point = maxComponent(start.power_rgb) > 0;
  const Vec3 normal = double_sided && side < 0.5f ? -at.geometric_normal : at.geometric_normal;
  start.point = {at.position, normal, start.power_rgb, source.index, 0};
  start.ray.direction = about(normal, sampleCosineHemisphere(direction));
  start.ray.origin = trace::Tracer::offsetOrigin(at.position, normal, start.ray.direction);
  return start;
}

void LightPaths::tracePath(const Source& source, uint32_t path, std::vector<VirtualPoint>& points) const {
  const Sampler sampler(seed_, kPathStream + source.index);
  const bool lamp = source.index < lights_.size();
  const Vec2 place = sampler.get2D(path, kStart), direction = sampler.get2D(path, kDirection);
  Start start =
      lamp ? startOfLamp(source, place, direction)
      : source.index > lights_.size()
           ? startOfSky(source, place, direction)
           : startOnEmitter(source, sampler.get1D(path, kPick), sampler.get1D(path, kSide), sampler.get1D(path, kPatch), place, direction);
  if (start.has_point) points.push_back(start.point);
  Rgb power_rgb = start.power_rgb;
  trace::Ray ray = start.ray;
  for (uint32_t bounce = 1; bounce <= most_bounces_ && maxComponent(power_rgb) > 0; ++bounce) {
    ray.key = mixBits(combineKeys(combineKeys(seed_, kPathStream + source.index), (uint64_t(path) << 16) + bounce));
    trace::Hit hit;
    tracer_.closest(std::span(&ray, 1), std::span(&hit, 1));
    if (hit.triangle == kNone) return;
    if (!hit.front && !scene_.materials[scene_.mesh.triangle_material[hit.triangle]].double_sided) return;
    if (lamp && bounce == 1) power_rgb *= rangeWindow(lights_[source.index], hit.t);
    const atlas::SurfacePoint at = atlas::surfacePoint(scene_.mesh, hit.triangle, hit.u, hit.v);
    // Irradiance is about the interpolated normal; the flux that came is about the triangle's.
    const float shading = -ray.direction.dot(hit.front ? at.normal : -at.normal), geometric = -ray.direction.dot(hit.geometric_normal);
    if (!(shading > 0) || !(geometric > 0)) return;
    const float before = maxComponent(power_rgb);
    power_rgb =
        power_rgb * scene::surfaceColor(scene_, hit.triangle, hit.u, hit.v).albedo_rgb * std::min(shading / geometric, kMostNormalGain);
    points.push_back({at.position, hit.geometric_normal, power_rgb, source.index, bounce});
    // Russian roulette by what the surface reflects: all virtual points of a path have about the same power.
    const uint32_t dimension = kFirstBounce + kPerBounce * bounce;
    const float survival = std::min(1.0f, maxComponent(power_rgb) / before);
    if (!(sampler.get1D(path, dimension) < survival)) return;
    power_rgb /= survival;
    ray.direction = about(hit.geometric_normal, sampleCosineHemisphere(sampler.get2D(path, dimension + 1)));
    ray.origin = trace::Tracer::offsetOrigin(at.position, hit.geometric_normal, ray.direction);
  }
}

std::vector<VirtualPoint> LightPaths::trace(uint32_t first, uint32_t end, const CancelFlag* cancel) const {
  std::vector<VirtualPoint> points;
  for (const Source& source : sources_)
    for (uint32_t path = std::max(first, source.first_path); path < std::min(end, source.end_path); ++path) {
      if (cancel && path % 64 == 0) cancel->check();
      tracePath(source, path - source.first_path, points);
    }
  return points;
}

}  // namespace lightwell::transport
