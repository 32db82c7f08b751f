#include "precompute/scene/portals.h"

#include <algorithm>
#include <cmath>

namespace lightwell::scene {
namespace {

constexpr double kElongated = 4;  // variances of a leaf's horizontal extents beyond which it has a direction of its own

/// Calls `each(position)` for the corners of a portal's triangles.
template <class Each>
void forCorners(const Scene& scene, const Portal& portal, const Each& each) {
  for (uint32_t t = portal.first_triangle; t < portal.first_triangle + portal.triangle_count; ++t)
    for (const uint32_t v : scene.mesh.triangles[t]) each(Vec3d(scene.mesh.positions[v]));
}

/// The direction of the widest horizontal extent.
Vec3d widestHorizontal(const Scene& scene, const Portal& portal) {
  // Second moments of the surface: a triangle's are those of its corners and three times its centre.
  double mass = 0, x = 0, z = 0, xx = 0, zz = 0, xz = 0;
  Imath::Box3d bounds;
  for (uint32_t t = portal.first_triangle; t < portal.first_triangle + portal.triangle_count; ++t) {
    Vec3d corner[4];
    for (size_t c = 0; c < 3; ++c) bounds.extendBy(corner[c] = Vec3d(scene.mesh.positions[scene.mesh.triangles[t][c]]));
    corner[3] = (corner[0] + corner[1] + corner[2]) / 3;
    const double area = (corner[1] - corner[0]).cross(corner[2] - corner[0]).length();
    for (size_t c = 0; c < 4; ++c) {
      const double weight = c < 3 ? area : 9 * area;
      mass += weight, x += weight * corner[c].x, z += weight * corner[c].z;
      xx += weight * corner[c].x * corner[c].x, zz += weight * corner[c].z * corner[c].z, xz += weight * corner[c].x * corner[c].z;
    }
  }
  const Vec3d by_axes = bounds.size().x >= bounds.size().z ? Vec3d(1, 0, 0) : Vec3d(0, 0, 1);
  if (!(mass > 0)) return by_axes;
  xx = xx / mass - x / mass * x / mass, zz = zz / mass - z / mass * z / mass, xz = xz / mass - x / mass * z / mass;
  const double middle = (xx + zz) / 2, radius = std::hypot((xx - zz) / 2, xz);
  if (!(middle + radius > kElongated * std::max(middle - radius, 0.0))) return by_axes;
  const double angle = std::atan2(2 * xz, xx - zz) / 2;
  const Vec3d direction(std::cos(angle), 0, std::sin(angle));
  const double along = std::abs(direction.x) >= std::abs(direction.z) ? direction.x : direction.z;
  return along < 0 ? -direction : direction;
}

}  // namespace

void addPortals(Scene& scene, const std::vector<gltf::PortalMark>& marks, const std::vector<uint32_t>& first_triangle, const std::vector<uint32_t>& end_triangle,
                Diagnostics& diagnostics) {
  for (size_t i = 0; i < marks.size(); ++i) {
    const gltf::PortalMark& mark = marks[i];
    Portal portal{.name = mark.name, .gltf_path = mark.path, .first_triangle = first_triangle[i], .triangle_count = end_triangle[i] - first_triangle[i],
                  .strips = mark.strips};
    if (portal.triangle_count == 0) {
      diagnostics.warn(mark.path, "has no surfaces and is no portal");
      continue;
    }
    const Vec3d direction = mark.opens_along.value_or(widestHorizontal(scene, portal));
    double low = std::numeric_limits<double>::infinity(), high = -low;
    forCorners(scene, portal, [&](const Vec3d& p) {
      low = std::min(low, direction.dot(p));
      high = std::max(high, direction.dot(p));
    });
    if (!(high - low > 1e-5)) {
      diagnostics.warn(mark.path, "has no extent along the direction in which it opens and is no portal");
      continue;
    }
    portal.axis = Vec3(direction / (high - low));
    portal.offset = float(-low / (high - low));
    scene.portals.push_back(std::move(portal));
  }
}

}  // namespace lightwell::scene
