#include "precompute/atlas/atlas.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "precompute/atlas/charts.h"
#include "precompute/atlas/coverage.h"
#include "precompute/atlas/slots.h"
#include "precompute/atlas/sources.h"
#include "precompute/atlas/unwrap.h"
#include "precompute/atlas/uv_check.h"
#include "precompute/core/random.h"

namespace lightwell::atlas {
namespace {

constexpr int kLargestSize = 8192;

/// The importer guarantees this; scenes built in code may not.
void requireConsistent(const scene::Scene& scene) {
  const scene::Mesh& mesh = scene.mesh;
  const auto require = [](bool holds, const char* what) {
    if (!holds) throw std::logic_error(std::string("buildAtlas: ") + what);
  };
  const size_t vertices = mesh.positions.size();
  require(mesh.normals.size() == vertices, "one normal per vertex");
  for (size_t size : {mesh.base_uv.size(), mesh.emissive_uv.size(), mesh.lightmap_uv.size(), mesh.colors.size()})
    require(size == 0 || size == vertices, "vertex arrays of one length");
  require(mesh.triangle_material.size() == mesh.triangles.size(), "one material per triangle");
  size_t triangles = 0;
  for (const scene::Object& object : scene.objects) {
    require(size_t(object.first_vertex) + object.vertex_count <= vertices, "vertices of objects inside the mesh");
    require(object.first_triangle == triangles, "objects list all triangles in order");
    triangles += object.triangle_count;
    require(triangles <= mesh.triangles.size(), "triangles of objects inside the mesh");
    for (uint32_t t = object.first_triangle; t < triangles; ++t)
      for (uint32_t v : mesh.triangles[t]) require(v - object.first_vertex < object.vertex_count, "triangles use vertices of their object");
  }
  require(triangles == mesh.triangles.size(), "every triangle in an object");
}

template <class T>
T interpolate(const std::vector<T>& attribute, const std::array<uint32_t, 3>& triangle, float u, float v) {
  return attribute[triangle[0]] * (1 - u - v) + attribute[triangle[1]] * u + attribute[triangle[2]] * v;
}

bool holdsTriangle(const Atlas& atlas, const Slot& slot, uint32_t triangle) {
  const auto first = atlas.patches.begin() + slot.first_patch;
  return std::any_of(first, first + slot.patch_count, [&](const Patch& patch) { return patch.triangle == triangle; });
}

/// The patch in which the running sum of areas exceeds `area`; the last one when none does.
uint32_t patchAtArea(const Atlas& atlas, const Slot& slot, float area) {
  if (!atlas.patch_cumulative_area.empty()) {
    const auto first = atlas.patch_cumulative_area.begin() + slot.first_patch, last = first + slot.patch_count - 1;
    return slot.first_patch + uint32_t(std::upper_bound(first, last, area) - first);
  }
  uint32_t patch = slot.first_patch;
  const uint32_t last = patch + slot.patch_count - 1;
  for (; patch < last && area >= atlas.patches[patch].area; ++patch) area -= atlas.patches[patch].area;
  return patch;
}

}  // namespace

Atlas buildAtlas(scene::Scene& scene, const AtlasOptions& options, Diagnostics& diagnostics, int threads) {
  if (options.size < 1 || options.size > kLargestSize)
    throw UsageError("the light map's size must be from 1 to " + std::to_string(kLargestSize) + ", not " + std::to_string(options.size));
  requireConsistent(scene);
  Atlas atlas;
  atlas.width = atlas.height = options.size;
  const UvCheck check = checkLightmapUv(scene, atlas.width, atlas.height);
  atlas.uv = layOut(scene, check, options, diagnostics, threads, atlas.unwrapped);
  buildCoverage(scene.mesh, atlas);
  findCharts(scene.mesh, atlas);
  fillSlots(scene, atlas, threads);
  fillSources(atlas, std::vector<uint8_t>(atlas.slots.size(), 1));
  return atlas;
}

uint32_t Atlas::slotAt(const scene::Mesh& mesh, uint32_t triangle, float u, float v) const {
  constexpr double kBorder = 1e-3;  // texels; points nearer to a texel's border may be on either side of it by rounding
  const Vec2 p = interpolate(uv, mesh.triangles[triangle], u, v);
  const double px = double(p.x) * width, py = double(p.y) * height;
  const int x = std::clamp(int(px), 0, width - 1), y = std::clamp(int(py), 0, height - 1);
  const uint32_t direct = texel_slot[size_t(y) * width + x];
  const bool inside = std::max(std::abs(px - x - 0.5), std::abs(py - y - 0.5)) < 0.5 - kBorder;
  if (direct != kNone && inside) return direct;

  uint32_t best = kNone;
  double best_distance2 = 2;  // those of the neighbours are at most 1 + 1, unless the point is off the atlas
  for (int ny = std::max(0, y - 1); ny <= std::min(height - 1, y + 1); ++ny)
    for (int nx = std::max(0, x - 1); nx <= std::min(width - 1, x + 1); ++nx) {
      const uint32_t slot = texel_slot[size_t(ny) * width + nx];
      if (slot == kNone || !holdsTriangle(*this, slots[slot], triangle)) continue;
      const double dx = std::max({nx - px, px - (nx + 1), 0.0}), dy = std::max({ny - py, py - (ny + 1), 0.0});
      if (dx * dx + dy * dy < best_distance2) {
        best_distance2 = dx * dx + dy * dy;
        best = slot;
      }
    }
  if (best != kNone) return best;
  if (direct != kNone) return direct;
  return triangle < triangle_slot.size() ? triangle_slot[triangle] : kNone;
}

SurfacePoint surfacePoint(const scene::Mesh& mesh, uint32_t triangle, float u, float v) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  SurfacePoint point{triangle, u, v, interpolate(mesh.positions, mesh.triangles[triangle], u, v), {}, {}};
  const Vec3d origin(mesh.positions[a]);
  const Vec3d cross = (Vec3d(mesh.positions[b]) - origin).cross(Vec3d(mesh.positions[c]) - origin);
  const double cross_length = cross.length();
  const Vec3 shading = interpolate(mesh.normals, mesh.triangles[triangle], u, v);
  const float shading_length = shading.length();
  // Either normal stands in for the other where that one vanishes.
  if (cross_length > 0) point.geometric_normal = Vec3(cross / cross_length);
  else point.geometric_normal = shading_length > 0 ? shading / shading_length : mesh.normals[a];
  point.normal = shading_length > 1e-6f ? shading / shading_length : point.geometric_normal;
  return point;
}

SurfacePoint sampleSlot(const scene::Mesh& mesh, const Atlas& atlas, const Slot& slot, float pick, const Vec2& u) {
  const Patch& patch = atlas.patches[patchAtArea(atlas, slot, pick * slot.area)];
  const Vec2 b = sampleTriangle(u);
  const Vec2 at = patch.corner[0] * (1 - b.x - b.y) + patch.corner[1] * b.x + patch.corner[2] * b.y;
  return surfacePoint(mesh, patch.triangle, at.x, at.y);
}

}  // namespace lightwell::atlas
