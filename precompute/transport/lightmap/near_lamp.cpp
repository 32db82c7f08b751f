#include "precompute/transport/lightmap/near_lamp.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "precompute/transport/solid_angle.h"

namespace lightwell::transport {
namespace {

constexpr double kNear = 3;          // of the texel's radius about its centroid
constexpr double kSpot = 0.25;       // height above the texel, likewise

}  // namespace

NearLamp nearLamp(const scene::Mesh& mesh, const atlas::Atlas& atlas, const PunctualLights& lamps, const atlas::Slot& slot, bool back) {
  NearLamp found;
  if (lamps.few().empty()) return found;
  const std::span patches = std::span(atlas.patches).subspan(slot.first_patch, slot.patch_count);
  const Vec3d centroid(slot.position);
  const auto corner = [&](const atlas::Patch& patch, int i) { return Vec3d(atlas::surfacePoint(mesh, patch.triangle, patch.corner[i].x, patch.corner[i].y).position); };
  double radius2 = 0;
  for (const atlas::Patch& patch : patches)
    for (int i = 0; i < 3; ++i) radius2 = std::max(radius2, (corner(patch, i) - centroid).length2());
  double nearest2 = kNear * kNear * radius2;
  for (const uint32_t i : lamps.few()) {
    const scene::Light& light = lamps.lights()[i];
    if (light.type != scene::LightType::point || light.range > 0) continue;
    const double distance2 = (Vec3d(light.position) - centroid).length2();
    if (distance2 < nearest2) nearest2 = distance2, found.light = i;
  }
  if (found.light == kNone) return found;
  const scene::Light& light = lamps.lights()[found.light];
  const Vec3d at(light.position);
  double seen_sr = 0, area = 0, height = HUGE_VAL;
  for (const atlas::Patch& patch : patches) {
    const Vec3d a = corner(patch, 0) - at, b = corner(patch, 1) - at, c = corner(patch, 2) - at;
    const Vec3d normal(atlas::surfacePoint(mesh, patch.triangle, 0, 0).geometric_normal);
    const double above = -a.dot(normal) * (back ? -1 : 1);
    area += double(patch.area);
    if (!(above > 0)) continue;
    seen_sr += triangleSolidAngle(a, b, c);
    height = std::min(height, above);
  }
  if (area > 0) found.irradiance_rgb = Vec3d(light.intensity) * (seen_sr / area);
  found.spot = height < kSpot * std::sqrt(radius2) && nearest2 < 4 * radius2;
  return found;
}

}  // namespace lightwell::transport
