// Scenes made in code: quads, triangles and boxes with or without light-map coordinates.
#pragma once
#include <initializer_list>
#include <string>
#include <vector>

#include "precompute/scene/scene.h"

namespace lightwell::atlas::test {

class SceneBuilder {
 public:
  SceneBuilder() {
    scene_.file = "test.glb";
    scene_.materials.resize(1);
  }

  /// Starts an object; the triangles that follow belong to it.
  SceneBuilder& object(bool has_lightmap_uv, uint32_t material = 0) {
    scene::Object object;
    object.gltf_path = "nodes[" + std::to_string(scene_.objects.size()) + "]";
    object.first_triangle = uint32_t(scene_.mesh.triangles.size());
    object.first_vertex = uint32_t(scene_.mesh.positions.size());
    object.has_lightmap_uv = has_lightmap_uv;
    scene_.objects.push_back(object);
    material_ = material;
    return *this;
  }
  SceneBuilder& triangle(const Vec3 (&p)[3], const Vec2 (&uv)[3] = {{NAN, NAN}, {NAN, NAN}, {NAN, NAN}}) {
    return polygon({p[0], p[1], p[2]}, {uv[0], uv[1], uv[2]});
  }
  /// A parallelogram from `corner` along `x`, then `y`; its coordinates go from `uv_low` to `uv_high`.
  SceneBuilder& quad(const Vec3& corner, const Vec3& x, const Vec3& y, const Vec2& uv_low = {NAN, NAN}, const Vec2& uv_high = {NAN, NAN}) {
    return polygon({corner, corner + x, corner + x + y, corner + y}, {uv_low, {uv_high.x, uv_low.y}, uv_high, {uv_low.x, uv_high.y}});
  }
  /// A box facing outward, as six quads of their own vertices, without coordinates.
  SceneBuilder& box(const Vec3& low, const Vec3& high) {
    const Vec3 d = high - low, x(d.x, 0, 0), y(0, d.y, 0), z(0, 0, d.z);
    quad(low, y, x).quad(low, x, z).quad(low, z, y);
    return quad(high, -x, -y).quad(high, -z, -x).quad(high, -y, -z);
  }
  scene::Scene build() const { return scene_; }
  scene::Scene& scene() { return scene_; }

 private:
  SceneBuilder& polygon(const std::vector<Vec3>& positions, const std::vector<Vec2>& uvs) {
    scene::Mesh& mesh = scene_.mesh;
    const uint32_t first = uint32_t(mesh.positions.size());
    Vec3 normal = (positions[1] - positions[0]).cross(positions[2] - positions[0]);
    normal = normal.length() > 0 ? normal.normalized() : Vec3(0, 0, 1);
    for (size_t i = 0; i < positions.size(); ++i) {
      mesh.positions.push_back(positions[i]);
      mesh.normals.push_back(normal);
      mesh.lightmap_uv.push_back(uvs[i]);
      scene_.bounds.extendBy(positions[i]);
    }
    for (uint32_t i = 2; i < positions.size(); ++i) {
      mesh.triangles.push_back({first, first + i - 1, first + i});
      mesh.triangle_material.push_back(material_);
      mesh.triangle_object.push_back(uint32_t(scene_.objects.size() - 1));
    }
    scene::Object& object = scene_.objects.back();
    object.triangle_count = uint32_t(mesh.triangles.size()) - object.first_triangle;
    object.vertex_count = uint32_t(mesh.positions.size()) - object.first_vertex;
    return *this;
  }

  scene::Scene scene_;
  uint32_t material_ = 0;
};

/// Area of all triangles, internal units².
inline double surfaceArea(const scene::Mesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const Vec3d p(mesh.positions[a]);
    area += 0.5 * (Vec3d(mesh.positions[b]) - p).cross(Vec3d(mesh.positions[c]) - p).length();
  }
  return area;
}

}  // namespace lightwell::atlas::test
