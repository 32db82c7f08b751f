#include "precompute/scene/albedo_check.h"

#include <algorithm>
#include <cstdio>

namespace lightwell::scene {
namespace {

/// Per channel, the brightest linear value of a picture.
Rgb brightestTexel(const Texture& texture) {
  uint8_t brightest[3] = {0, 0, 0};
  for (size_t i = 0; i < texture.rgba.size(); i += 4)
    for (size_t c = 0; c < 3; ++c) brightest[c] = std::max(brightest[c], texture.rgba[i + c]);
  const Texture pixel{1, 1, {brightest[0], brightest[1], brightest[2], 255}};
  const auto linear = sampleTexture(pixel, Vec2(0));
  return {linear[0], linear[1], linear[2]};
}

/// Per material and channel, the brightest vertex colour on it.
std::vector<Rgb> brightestVertexColors(const Scene& scene) {
  const Mesh& mesh = scene.mesh;
  std::vector<Rgb> brightest(scene.materials.size(), Rgb(mesh.colors.empty() ? 1.0f : 0.0f));
  if (mesh.colors.empty()) return brightest;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const uint32_t v : mesh.triangles[t])
      for (int c = 0; c < 3; ++c) {
        float& channel = brightest[mesh.triangle_material[t]][c];
        channel = std::max(channel, mesh.colors[v][size_t(c)]);
      }
  return brightest;
}

}  // namespace

void reportHighAlbedo(const Scene& scene, Diagnostics& diagnostics) {
  constexpr float kMaxAlbedo = 0.999f;
  const std::vector<Rgb> vertex_color = brightestVertexColors(scene);
  std::vector<Rgb> texel(scene.textures.size());
  for (size_t i = 0; i < texel.size(); ++i) texel[i] = brightestTexel(scene.textures[i]);
  for (size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    Rgb albedo = material.base_color * vertex_color[m];
    if (material.base_color_texture != kNone) albedo *= texel[material.base_color_texture];
    if (!(maxComponent(albedo) > kMaxAlbedo)) continue;
    char text[64];
    std::snprintf(text, sizeof text, "the albedo reaches %.4f; it is kept at 0.999", double(maxComponent(albedo)));
    diagnostics.warn(material.gltf_path, "material \"" + material.name + "\": " + text);
  }
}

}  // namespace lightwell::scene
