#include "precompute/transport/lightmap/plain_emitters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/core/random.h"
#include "precompute/transport/lambert.h"

namespace lightwell::transport {
namespace {

constexpr size_t kMostTriangles = 16;
constexpr double kTouching = 1e-6;        // height over the emitter's plane, in sizes of the emitter: nothing comes from the surface a point lies on
constexpr double kLeastSolidAngle = 1e-3; // below, spherical and plane sampling are the same, and the plane's is stable

double angleBetween(const Vec3d& a, const Vec3d& b) { return std::atan2(a.cross(b).length(), a.dot(b)); }

/// Unit, orthogonal to `b`.
Vec3d besides(const Vec3d& a, const Vec3d& b) {
  const Vec3d rest = a - b * a.dot(b);
  const double length = rest.length();
  return length > 0 ? rest / length : Vec3d(0.0);
}

}  // namespace

PlainEmitters::PlainEmitters(const scene::Scene& scene) {
  const scene::Mesh& mesh = scene.mesh;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const scene::Material& material = scene.materials[mesh.triangle_material[t]];
    if (!(maxComponent(material.emissive) > 0.0f)) continue;
    if (material.emissive_texture != kNone || triangles_.size() == kMostTriangles) {
      triangles_.clear();
      return;
    }
    Triangle emitter;
    emitter.triangle = t;
    for (size_t i = 0; i < 3; ++i) emitter.corner[i] = Vec3d(mesh.positions[mesh.triangles[t][i]]);
    const Vec3d cross = (emitter.corner[1] - emitter.corner[0]).cross(emitter.corner[2] - emitter.corner[0]);
    emitter.area = cross.length() / 2;
    if (!(emitter.area > 0)) continue;
    emitter.normal = cross / (2 * emitter.area);
    emitter.size = std::sqrt(emitter.area);
    emitter.radiance_rgb = scene::surfaceColor(scene, t, 1.0f / 3, 1.0f / 3).emitted_radiance_rgb;
    emitter.double_sided = material.double_sided;
    triangles_.push_back(emitter);
  }
}

float PlainEmitters::irradiance(uint32_t index, const Vec3& position, const Vec3& normal) const {
  const Triangle& emitter = triangles_[index];
  const Vec3d at(position);
  const double height = (at - emitter.corner[0]).dot(emitter.normal);
  if (emitter.double_sided ? std::abs(height) < kTouching * emitter.size : height < kTouching * emitter.size) return 0.0f;
  const std::array<Vec3d, 3> corners = {emitter.corner[0] - at, emitter.corner[1] - at, emitter.corner[2] - at};
  return float(polygonIrradiance(corners, Vec3d(normal)));
}

PlainEmitters::Sample PlainEmitters::sample(uint32_t index, const Vec3& position, const Vec3& normal, const Vec2& u) const {
  const Triangle& emitter = triangles_[index];
  const Vec3d at(position);
  const Vec3d to[3] = {emitter.corner[0] - at, emitter.corner[1] - at, emitter.corner[2] - at};
  const Vec3d a = to[0].normalized(), b = to[1].normalized(), c = to[2].normalized();
  const Vec3d ab = a.cross(b), bc = b.cross(c), ca = c.cross(a);
  const double alpha = angleBetween(ab, ca * -1.0), beta = angleBetween(bc, ab * -1.0), gamma = angleBetween(ca, bc * -1.0);
  const double solid_angle = alpha + beta + gamma - double(kPi);
  Vec3d direction;
  double density = 0;
  if (solid_angle > kLeastSolidAngle) {
    const double part = double(u.x) * solid_angle;
    const double s = std::sin(part - alpha), t = std::cos(part - alpha), ca_ = std::cos(alpha), sa = std::sin(alpha);
    const double p = t - ca_, v = s + sa * a.dot(b);
    const double divisor = (v * s + p * t) * sa;
    const double q = std::clamp(divisor != 0 ? ((v * t - p * s) * ca_ - v) / divisor : 1.0, -1.0, 1.0);
    const Vec3d third = a * q + besides(c, a) * std::sqrt(1 - q * q);
    const double z = std::clamp(1 - double(u.y) * (1 - third.dot(b)), -1.0, 1.0);
    direction = (b * z + besides(third, b) * std::sqrt(1 - z * z)).normalized();
    density = 1 / solid_angle;
  } else {
    const Vec2 place = sampleTriangle(u);
    const Vec3d offset = to[0] * double(place.x) + to[1] * double(place.y) + to[2] * (1.0 - double(place.x) - double(place.y));
    const double distance = offset.length();
    if (!(distance > 0)) return {Vec3(0.0f), 0.0f};
    direction = offset / distance;
    const double cos_emitter = std::abs(direction.dot(emitter.normal));
    if (!(cos_emitter > 0)) return {Vec3(0.0f), 0.0f};
    density = distance * distance / (cos_emitter * emitter.area);
  }
  const double cosine = direction.dot(Vec3d(normal));
  const bool seen = emitter.double_sided || direction.dot(emitter.normal) < 0;
  return {Vec3(direction), seen && cosine > 0 ? float(cosine / density) : 0.0f};
}

}  // namespace lightwell::transport
