#include "precompute/scene/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "precompute/scene/normal_transform.h"

namespace lightwell::scene {
namespace {

using Corners = std::array<uint32_t, 3>;

/// Twice the area below which, or height relative to the longest edge below which, a triangle has no direction that a float could hold.
constexpr double kMinDoubleArea = 1e-18, kMinRelativeHeight = 1e-9;

Vec3d doubleAreaNormal(const Vec3& a, const Vec3& b, const Vec3& c) { return (Vec3d(b) - Vec3d(a)).cross(Vec3d(c) - Vec3d(a)); }

bool isDegenerate(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest2 = std::max({(Vec3d(b) - Vec3d(a)).length2(), (Vec3d(c) - Vec3d(b)).length2(), (Vec3d(a) - Vec3d(c)).length2()});
  const double double_area = doubleAreaNormal(a, b, c).length();
  return !(double_area > kMinDoubleArea && double_area > kMinRelativeHeight * longest2);
}

/// The used vertices of a primitive, renumbered.
struct Selection {
  std::vector<uint32_t> vertices;    // of the primitive
  std::vector<Corners> triangles;    // indices into `vertices`
};

/// Shared vertices, for primitives with normals.
Selection selectShared(std::span<const Corners> triangles, size_t vertex_count) {
  Selection selection;
  std::vector<uint32_t> renumbered(vertex_count, kNone);
  for (const Corners& triangle : triangles) {
    Corners corners;
    for (size_t k = 0; k < 3; ++k) {
      uint32_t& number = renumbered[triangle[k]];
      if (number == kNone) {
        number = uint32_t(selection.vertices.size());
        selection.vertices.push_back(triangle[k]);
      }
      corners[k] = number;
    }
    selection.triangles.push_back(corners);
  }
  return selection;
}

/// Three vertices for each triangle, for flat normals.
Selection selectUnshared(std::span<const Corners> triangles) {
  Selection selection;
  for (const Corners& triangle : triangles) {
    const auto first = uint32_t(selection.vertices.size());
    selection.vertices.insert(selection.vertices.end(), triangle.begin(), triangle.end());
    selection.triangles.push_back({first, first + 1, first + 2});
  }
  return selection;
}

/// Appends the selected elements; `missing` stands for those of earlier or later objects without this attribute.
template <typename T>
void appendAttribute(std::vector<T>& attribute, const std::vector<T>& values, const Selection& selection, size_t first_vertex,
                     const T& missing) {
  if (values.empty() && attribute.empty()) return;
  attribute.resize(first_vertex, missing);
  for (const uint32_t v : selection.vertices) attribute.push_back(values.empty() ? missing : values[v]);
}

void count(size_t& counter, std::string& first, const std::string& path, size_t added) {
  if (counter == 0 && added > 0) first = path;
  counter += added;
}

void warnCounted(Diagnostics& diagnostics, size_t counter, const std::string& first, const std::string& what) {
  if (counter > 0) diagnostics.warn(first, std::to_string(counter) + " " + what + ", the first of them here");
}

}  // namespace

void MeshBuilder::add(const gltf::Primitive& primitive, const gltf::Matrix& world, uint32_t material, std::string path, std::string name) {
  std::vector<Vec3> positions(primitive.positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    Vec3d world_m;
    world.multVecMatrix(Vec3d(primitive.positions[i]), world_m);
    positions[i] = frame_.toInternal(world_m);
  }
  const NormalTransform normal_transform(world);
  std::vector<Corners> kept;
  kept.reserve(primitive.triangles.size());
  for (Corners t : primitive.triangles) {
    if (isDegenerate(positions[t[0]], positions[t[1]], positions[t[2]])) continue;
    if (normal_transform.mirrored()) std::swap(t[1], t[2]);
    kept.push_back(t);
  }
  count(degenerate_, first_degenerate_, path, primitive.triangles.size() - kept.size());
  if (kept.empty()) return;

  const bool flat = primitive.normals.empty();
  const Selection selection = flat ? selectUnshared(kept) : selectShared(kept, positions.size());
  std::vector<Vec3d> face_normal(selection.vertices.size(), Vec3d(0));  // area-weighted sum over the faces of a vertex
  std::vector<Vec3d> any_normal(selection.vertices.size());             // of one of them
  for (size_t i = 0; i < kept.size(); ++i) {
    const Vec3d n = doubleAreaNormal(positions[kept[i][0]], positions[kept[i][1]], positions[kept[i][2]]);
    for (const uint32_t v : selection.triangles[i]) {
      face_normal[v] += n;
      any_normal[v] = n;
    }
  }

  Mesh& mesh = scene_.mesh;
  Object object;
  object.first_vertex = uint32_t(mesh.positions.size());
  object.vertex_count = uint32_t(selection.vertices.size());
  object.first_triangle = uint32_t(mesh.triangles.size());
  object.triangle_count = uint32_t(selection.triangles.size());
  object.has_lightmap_uv = !primitive.lightmap_uv.empty();
  size_t flipped = 0, replaced = 0;
  for (size_t v = 0; v < selection.vertices.size(); ++v) {
    mesh.positions.push_back(positions[selection.vertices[v]]);
    Vec3 n = flat ? Vec3(0) : normal_transform.apply(primitive.normals[selection.vertices[v]]);
    if (n == Vec3(0)) {
      const double length = face_normal[v].length();
      n = Vec3(length > 0 ? face_normal[v] / length : any_normal[v].normalized());
      if (!flat) ++replaced;
    } else if (Vec3d(n).dot(face_normal[v]) < 0) {
      n = -n;
      ++flipped;
    }
    mesh.normals.push_back(n);
  }
  count(flipped_, first_flipped_, path, flipped);
  count(replaced_, first_replaced_, path, replaced);

  const float nan = std::numeric_limits<float>::quiet_NaN();
  appendAttribute(mesh.base_uv, primitive.base_uv, selection, object.first_vertex, Vec2(0));
  appendAttribute(mesh.emissive_uv, primitive.emissive_uv, selection, object.first_vertex, Vec2(0));
  appendAttribute(mesh.lightmap_uv, primitive.lightmap_uv, selection, object.first_vertex, Vec2(nan, nan));
  appendAttribute(mesh.colors, primitive.colors, selection, object.first_vertex, {1, 1, 1, 1});
  const uint32_t base = object.first_vertex;
  for (const Corners& t : selection.triangles) mesh.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  mesh.triangle_material.resize(mesh.triangles.size(), material);
  mesh.triangle_object.resize(mesh.triangles.size(), uint32_t(scene_.objects.size()));
  object.gltf_path = std::move(path);
  object.name = std::move(name);
  scene_.objects.push_back(std::move(object));
}

void MeshBuilder::report(Diagnostics& diagnostics) const {
  warnCounted(diagnostics, degenerate_, first_degenerate_, "triangles are degenerate and dropped");
  warnCounted(diagnostics, flipped_, first_flipped_, "vertex normals point away from the front of their faces and are turned around");
  warnCounted(diagnostics, replaced_, first_replaced_, "vertex normals are zero and replaced by those of the faces");
}

}  // namespace lightwell::scene
