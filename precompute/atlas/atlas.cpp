#include "precompute/atlas/atlas.h"

#include <algorithm>
#include <span>
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

namespace {

/// Whether a slot's surface covers the centre of its texel (to within kCentreTolerance texels: centres often lie on edges), or half of the texel.
bool coversCentreOrHalf(const scene::Mesh& mesh, const Atlas& atlas, const Slot& slot) {
  constexpr double kCentreTolerance = 1e-3;
  double share = 0;
  for (const auto& patch : std::span(atlas.patches).subspan(slot.first_patch, slot.patch_count)) {
    double x[3], y[3];  // in texels, from the centre
    for (int i = 0; i < 3; ++i) {
      const Vec2 uv = interpolate(atlas.uv, mesh.triangles[patch.triangle], patch.corner[i].x, patch.corner[i].y);
      x[i] = double(uv.x) * atlas.width - (slot.texel % uint32_t(atlas.width)) - 0.5;
      y[i] = double(uv.y) * atlas.height - (slot.texel / uint32_t(atlas.width)) - 0.5;
    }
    const double twice_area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    const double sense = twice_area < 0 ? -1 : 1;
    bool centre = twice_area != 0;
    for (int i = 0; i < 3; ++i) {
      const int next = (i + 1) % 3;
      const double length = std::hypot(x[next] - x[i], y[next] - y[i]);
      centre = centre && sense * (x[i] * y[next] - x[next] * y[i]) >= -kCentreTolerance * length;
    }
    if (centre) return true;
    share += 0.5 * std::abs(twice_area);
  }
  return share >= 0.5;
}

}  // namespace

std::vector<char> standingSlots(const scene::Mesh& mesh, const Atlas& atlas) {
  std::vector<char> covers(atlas.slots.size());
  for (size_t i = 0; i < atlas.slots.size(); ++i) covers[i] = coversCentreOrHalf(mesh, atlas, atlas.slots[i]);
  std::vector<char> standing = covers;
  for (size_t i = 0; i < atlas.slots.size(); ++i) {
    if (covers[i]) continue;
    const int x = int(atlas.slots[i].texel % uint32_t(atlas.width)), y = int(atlas.slots[i].texel / uint32_t(atlas.width));
    bool represented = false;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, atlas.height - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, atlas.width - 1); ++u) {
        const uint32_t neighbour = atlas.texel_slot[size_t(v) * atlas.width + u];
        represented = represented || (neighbour != kNone && covers[neighbour] && atlas.slots[neighbour].chart == atlas.slots[i].chart);
      }
    standing[i] = !represented;
  }
  return standing;
}

SurfacePoint sampleSlot(const scene::Mesh& mesh, const Atlas& atlas, const Slot& slot, float pick, const Vec2& u) {
  const Patch& patch = atlas.patches[patchAtArea(atlas, slot, pick * slot.area)];
  const Vec2 b = sampleTriangle(u);
  const Vec2 at = patch.corner[0] * (1 - b.x - b.y) + patch.corner[1] * b.x + patch.corner[2] * b.y;
  return surfacePoint(mesh, patch.triangle, at.x, at.y);
}

}  // namespace lightwell::atlas
