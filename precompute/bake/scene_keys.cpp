#include "precompute/bake/scene_keys.h"

#include <algorithm>

namespace lightwell::bake {
namespace {

template <class T>
void addVector(KeyHasher& hasher, const std::vector<T>& values) {
  static_assert(std::is_standard_layout_v<T>);
  hasher.addArray(values.data(), values.size());
}

void addAlpha(KeyHasher& hasher, const scene::Texture& texture) {
  std::vector<uint8_t> alpha(texture.rgba.size() / 4);
  for (size_t i = 0; i < alpha.size(); ++i) alpha[i] = texture.rgba[4 * i + 3];
  hasher.add(texture.width).add(texture.height).add(texture.wrap_u).add(texture.wrap_v);
  addVector(hasher, alpha);
}

void addTexture(KeyHasher& hasher, const scene::Texture& texture) {
  hasher.add(texture.width).add(texture.height).add(texture.wrap_u).add(texture.wrap_v);
  addVector(hasher, texture.rgba);
}

/// Materials by what they are, not by their number or name.
template <class Describe>
std::vector<Key> materialKeys(const scene::Scene& scene, const Describe& describe) {
  std::vector<Key> keys;
  for (const auto& material : scene.materials) {
    KeyHasher hasher;
    describe(hasher, material);
    keys.push_back(hasher.finish());
  }
  return keys;
}

void addPerTriangle(KeyHasher& hasher, const scene::Mesh& mesh, const std::vector<Key>& of_material) {
  std::vector<Key> keys;
  keys.reserve(mesh.triangles.size());
  for (const uint32_t material : mesh.triangle_material) keys.push_back(of_material.at(material));
  addVector(hasher, keys);
}

Key hashGeometry(const scene::Scene& scene, const plan::Settings& settings) {
  const scene::Mesh& mesh = scene.mesh;
  KeyHasher hasher;
  hasher.add(settings.lightmap_size).add(settings.seed).add(scene.metres_per_unit);
  addVector(hasher, mesh.positions);
  addVector(hasher, mesh.normals);
  addVector(hasher, mesh.lightmap_uv);
  addVector(hasher, mesh.triangles);
  addVector(hasher, mesh.triangle_object);
  addPerTriangle(hasher, mesh, materialKeys(scene, [&](KeyHasher& h, const scene::Material& m) {
                   h.add(m.alpha_mode).add(m.double_sided);
                   if (m.alpha_mode == scene::AlphaMode::opaque) return;
                   h.add(m.alpha).add(m.alpha_cutoff);
                   if (m.base_color_texture != kNone) addAlpha(h, scene.textures[m.base_color_texture]);
                 }));
  const bool cut_out = std::any_of(scene.materials.begin(), scene.materials.end(),
                                   [](const auto& m) { return m.alpha_mode != scene::AlphaMode::opaque; });
  if (cut_out) {
    addVector(hasher, mesh.base_uv);
    for (const auto& color : mesh.colors) hasher.add(color[3]);
  }
  return hasher.finish();
}

Key hashReflection(const scene::Scene& scene, const Key& geometry) {
  KeyHasher hasher;
  hasher.add(geometry);
  addVector(hasher, scene.mesh.base_uv);
  addVector(hasher, scene.mesh.colors);
  addPerTriangle(hasher, scene.mesh, materialKeys(scene, [&](KeyHasher& h, const scene::Material& m) {
                   h.addArray(&m.base_color, 1);
                   if (m.base_color_texture != kNone) addTexture(h, scene.textures[m.base_color_texture]);
                 }));
  return hasher.finish();
}

Key hashEmission(const scene::Scene& scene, const Key& geometry) {
  KeyHasher hasher;
  hasher.add(geometry);
  addVector(hasher, scene.mesh.emissive_uv);
  addPerTriangle(hasher, scene.mesh, materialKeys(scene, [&](KeyHasher& h, const scene::Material& m) {
                   h.addArray(&m.emissive, 1);
                   if (m.emissive_texture != kNone) addTexture(h, scene.textures[m.emissive_texture]);
                 }));
  return hasher.finish();
}

Key hashPortals(const scene::Scene& scene) {
  if (scene.portals.empty()) return {};
  KeyHasher hasher;
  for (const auto& portal : scene.portals)
    hasher.add(portal.name).add(portal.first_triangle).add(portal.triangle_count).addArray(&portal.axis, 1).add(portal.offset).add(portal.strips);
  return hasher.finish();
}

Key hashLights(const scene::Scene& scene) {
  KeyHasher hasher;
  hasher.add(scene.origin_m.x).add(scene.origin_m.y).add(scene.origin_m.z).add(scene.metres_per_unit);
  for (const auto& light : scene.lights)
    hasher.add(light.type).add(light.name).addArray(&light.position, 1).addArray(&light.direction, 1).addArray(&light.intensity, 1)
        .add(light.inner_cone_angle).add(light.outer_cone_angle).add(light.range);
  return hasher.finish();
}

}  // namespace

SceneKeys sceneKeys(const scene::Scene& scene, const plan::Settings& settings) {
  SceneKeys keys;
  keys.geometry = hashGeometry(scene, settings);
  keys.reflection = hashReflection(scene, keys.geometry);
  keys.emission = hashEmission(scene, keys.geometry);
  keys.surfaces = KeyHasher().add(keys.reflection).add(keys.emission).finish();
  keys.lights = hashLights(scene);
  keys.portals = hashPortals(scene);
  return keys;
}

Key chartKey(const scene::Scene& scene, std::span<const size_t> objects) {
  KeyHasher hasher;
  std::vector<Vec3> corners;
  for (const size_t index : objects) {
    const scene::Object& object = scene.objects[index];
    corners.clear();
    for (uint32_t t = 0; t < object.triangle_count; ++t)
      for (const uint32_t vertex : scene.mesh.triangles[object.first_triangle + t]) corners.push_back(scene.mesh.positions[vertex]);
    addVector(hasher, corners);
  }
  return hasher.finish();
}

}  // namespace lightwell::bake
