// Scenes and atlases made in code, for tests whose answers are known in closed form.
#pragma once
#include <array>
#include <initializer_list>
#include <string>

#include "precompute/atlas/atlas.h"
#include "precompute/scene/scene.h"

namespace lightwell::test {

inline scene::Material diffuse(float albedo, float emitted_radiance = 0.0f) {
  scene::Material material;
  material.base_color = Rgb(albedo);
  material.emissive = Rgb(emitted_radiance);
  return material;
}

/// Builds a scene of quads. Quad q is made of triangles 2q and 2q + 1 and is an object of its own.
class SceneBuilder {
 public:
  uint32_t material(const scene::Material& material) {
    scene_.materials.push_back(material);
    return uint32_t(scene_.materials.size()) - 1;
  }
  /// The parallelogram origin + s * edge_s + t * edge_t, s and t in [0, 1]; its front is the side of edge_s × edge_t.
  SceneBuilder& quad(const Vec3& origin, const Vec3& edge_s, const Vec3& edge_t, uint32_t material) {
    scene::Mesh& mesh = scene_.mesh;
    const uint32_t vertex = uint32_t(mesh.positions.size()), triangle = uint32_t(mesh.triangles.size());
    const Vec3 normal = edge_s.cross(edge_t).normalized();
    const std::array<Vec2, 4> corner = {Vec2(0, 0), Vec2(1, 0), Vec2(1, 1), Vec2(0, 1)};
    for (const Vec2& c : corner) {
      mesh.positions.push_back(origin + edge_s * c.x + edge_t * c.y);
      mesh.normals.push_back(normal);
      mesh.base_uv.push_back(c);
      mesh.emissive_uv.push_back(c);
      scene_.bounds.extendBy(mesh.positions.back());
    }
    mesh.triangles.push_back({vertex, vertex + 1, vertex + 2});
    mesh.triangles.push_back({vertex, vertex + 2, vertex + 3});
    scene::Object object;
    object.name = "quad " + std::to_string(scene_.objects.size());
    object.first_triangle = triangle, object.triangle_count = 2;
    object.first_vertex = vertex, object.vertex_count = 4;
    mesh.triangle_material.insert(mesh.triangle_material.end(), 2, material);
    mesh.triangle_object.insert(mesh.triangle_object.end(), 2, uint32_t(scene_.objects.size()));
    scene_.objects.push_back(object);
    return *this;
  }
  /// The six walls of a box, their fronts inward: floor, ceiling, -x, +x, -z, +z.
  SceneBuilder& room(const Vec3& low, const Vec3& high, uint32_t material) {
    const Vec3 x(high.x - low.x, 0, 0), y(0, high.y - low.y, 0), z(0, 0, high.z - low.z);
    quad(low, z, x, material).quad(low + y, x, z, material);
    quad(low, y, z, material).quad(low + x, z, y, material);
    return quad(low, x, y, material).quad(low + z, y, x, material);
  }
  scene::Scene take() { return std::move(scene_); }

 private:
  scene::Scene scene_;
};

/// A closed box of equal walls around the origin, fronts inward.
inline scene::Scene closedBox(const Vec3& half_size, const scene::Material& wall) {
  SceneBuilder builder;
  builder.room(-half_size, half_size, builder.material(wall));
  return builder.take();
}

inline scene::Light pointLight(const Vec3& position, float intensity) {
  scene::Light light;
  light.position = position;
  light.intensity = Rgb(intensity);
  return light;
}

/// An atlas with one chart of cells × cells texels per quad of the given ones (all when empty), side by side in a row.
inline atlas::Atlas quadAtlas(const scene::Scene& scene, int cells, std::initializer_list<uint32_t> quads = {}) {
  std::vector<uint32_t> chosen(quads);
  if (chosen.empty())
    for (uint32_t q = 0; q < scene.objects.size(); ++q) chosen.push_back(q);
  const scene::Mesh& mesh = scene.mesh;
  atlas::Atlas atlas;
  atlas.width = cells * int(chosen.size());
  atlas.height = cells;
  atlas.chart_count = uint32_t(chosen.size());
  atlas.uv.assign(mesh.positions.size(), Vec2(0, 0));
  atlas.texel_slot.assign(size_t(atlas.width) * atlas.height, kNone);
  atlas.source.assign(size_t(atlas.width) * atlas.height, kNone);
  // Corner (s, t) of a quad as barycentrics of its lower (t ≤ s) or upper triangle.
  const auto barycentrics = [](bool upper, const Vec2& c) { return upper ? Vec2(c.x, c.y - c.x) : Vec2(c.x - c.y, c.y); };
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < atlas.width; ++x) {
      const uint32_t chart = uint32_t(x / cells), quad = chosen[chart];
      const int column = x % cells;
      const Vec3* p = &mesh.positions[scene.objects[quad].first_vertex];
      const Vec3 edge_s = p[1] - p[0], edge_t = p[3] - p[0];
      const auto corner = [&](int i, int j) { return Vec2(float(column + i) / float(cells), float(y + j) / float(cells)); };
      atlas::Slot slot{};
      slot.texel = uint32_t(y * atlas.width + x);
      slot.chart = chart;
      slot.first_patch = uint32_t(atlas.patches.size());
      slot.area = edge_s.cross(edge_t).length() / float(cells * cells);
      const Vec2 middle = (corner(0, 0) + corner(1, 1)) * 0.5f;
      slot.position = p[0] + edge_s * middle.x + edge_t * middle.y;
      slot.normal = mesh.normals[scene.objects[quad].first_vertex];
      const scene::Material& material = scene.materials[mesh.triangle_material[2 * quad]];
      slot.albedo_rgb = material.base_color;
      slot.emitted_radiance_rgb = material.emissive;
      slot.double_sided = material.double_sided;
      for (const bool upper_half : {false, true}) {
        const bool upper_triangle = column < y || (column == y && upper_half);
        const Vec2 third = upper_half ? corner(0, 1) : corner(1, 0);
        atlas::Patch patch{};
        patch.triangle = 2 * quad + (upper_triangle ? 1 : 0);
        patch.corner[0] = barycentrics(upper_triangle, corner(0, 0));
        patch.corner[1] = barycentrics(upper_triangle, third);
        patch.corner[2] = barycentrics(upper_triangle, corner(1, 1));
        patch.area = slot.area / 2;
        atlas.patches.push_back(patch);
      }
      slot.patch_count = 2;
      atlas.texel_slot[slot.texel] = uint32_t(atlas.slots.size());
      atlas.source[slot.texel] = slot.texel;
      atlas.slots.push_back(slot);
    }
  return atlas;
}

/// Mean over the slots, weighted by their area.
inline double meanOverArea(const atlas::Atlas& atlas, const std::vector<Rgb>& value_rgb) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < value_rgb.size(); ++i) {
    sum += double(luminance(value_rgb[i])) * atlas.slots[i].area;
    area += atlas.slots[i].area;
  }
  return sum / area;
}

}  // namespace lightwell::test
