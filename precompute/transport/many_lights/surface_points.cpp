#include "precompute/transport/many_lights/surface_points.h"

#include <algorithm>
#include <cmath>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kPointStream = 13ull << 40;
constexpr uint32_t kMostTriesPerPoint = 16;
enum Dimension : uint32_t { kPlace = 0, kAlpha = 1 };

/// Every third bit of the result is one of the lowest ten of v.
uint32_t spreadBits(uint32_t v) {
  v = (v | v << 16) & 0x030000ffu;
  v = (v | v << 8) & 0x0300f00fu;
  v = (v | v << 4) & 0x030c30c3u;
  return (v | v << 2) & 0x09249249u;
}

/// Triangles along a Morton curve, with their areas summed up.
struct Curve {
  std::vector<uint32_t> triangle;
  std::vector<double> area_end;

  explicit Curve(const scene::Scene& scene) {
    const auto& mesh = scene.mesh;
    std::vector<std::pair<uint32_t, uint32_t>> order;
    const Vec3 origin = scene.bounds.isEmpty() ? Vec3(0.0f) : scene.bounds.min, size = scene.bounds.isEmpty() ? Vec3(1.0f) : scene.bounds.size();
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& v = mesh.triangles[t];
      const Vec3 middle = (mesh.positions[v[0]] + mesh.positions[v[1]] + mesh.positions[v[2]]) / 3.0f - origin;
      uint32_t code = 0;
      for (int k = 0; k < 3; ++k) code |= spreadBits(uint32_t(std::clamp(middle[k] / std::max(size[k], 1e-20f), 0.0f, 1.0f) * 1023.0f)) << k;
      order.push_back({code, t});
    }
    std::sort(order.begin(), order.end());
    double sum = 0;
    for (const auto& [code, t] : order) {
      const auto& v = mesh.triangles[t];
      const Vec3d a(mesh.positions[v[0]]), b(mesh.positions[v[1]]), c(mesh.positions[v[2]]);
      const double area = 0.5 * (b - a).cross(c - a).length();
      if (!(area > 0)) continue;
      triangle.push_back(t);
      area_end.push_back(sum += area);
    }
  }
  double area() const { return area_end.empty() ? 0 : area_end.back(); }
};

}  // namespace

SurfacePoints spreadPoints(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t count, uint64_t seed) {
  SurfacePoints spread;
  const Curve curve(scene);
  if (!(curve.area() > 0) || count == 0) return spread;
  const Sampler sampler(seed, kPointStream);
  uint32_t tried = 0;
  spread.points.reserve(count);
  for (; spread.points.size() < count && tried / kMostTriesPerPoint < count; ++tried) {
    const Vec2 place = sampler.get2D(tried, kPlace);
    const double along = double(place.x) * curve.area();
    const size_t i = std::min(size_t(std::upper_bound(curve.area_end.begin(), curve.area_end.end(), along) - curve.area_end.begin()), curve.triangle.size() - 1);
    const double begin = i ? curve.area_end[i - 1] : 0.0;
    const float within = std::clamp(float((along - begin) / (curve.area_end[i] - begin)), 0.0f, 0x1.fffffep-1f);
    const uint32_t triangle = curve.triangle[i];
    const Vec2 at = sampleTriangle({within, place.y});
    if (!(sampler.get1D(tried, kAlpha) < scene::surfaceAlpha(scene, triangle, at.x, at.y))) continue;
    const atlas::SurfacePoint surface = atlas::surfacePoint(scene.mesh, triangle, at.x, at.y);
    const uint32_t slot = atlas.slotAt(scene.mesh, triangle, at.x, at.y);
    spread.points.push_back({surface.position, surface.geometric_normal, slot == kNone ? kNone : atlas.source[atlas.slots[slot].texel]});
  }
  spread.area = tried ? curve.area() * double(spread.points.size()) / double(tried) : 0;
  return spread;
}

}  // namespace lightwell::transport
