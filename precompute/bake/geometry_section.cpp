// The section "geometry": what a renderer draws and what a shadow ray meets.
#include <algorithm>
#include <map>

#include "format/decode/pixel.h"
#include "precompute/bake/sections.h"
#include "precompute/core/error.h"

namespace lightwell::bake {
namespace {

v1::WrapMode wrapMode(scene::Texture::Wrap wrap) {
  switch (wrap) {
    case scene::Texture::Wrap::clamp: return v1::WRAP_MODE_CLAMP;
    case scene::Texture::Wrap::mirror: return v1::WRAP_MODE_MIRROR;
    case scene::Texture::Wrap::repeat: break;
  }
  return v1::WRAP_MODE_REPEAT;
}

/// Collects the distinct ways in which triangles let light through, and the alpha channels of their textures.
class AlphaTable {
 public:
  static constexpr uint16_t kOpaque = 0xffff;
  explicit AlphaTable(const scene::Scene& scene) : scene_(scene) {}

  /// The index for chunk "triangle_alpha".
  uint16_t add(uint32_t triangle) {
    const uint32_t material_index = scene_.mesh.triangle_material[triangle];
    const scene::Material& material = scene_.materials[material_index];
    if (material.alpha_mode == scene::AlphaMode::opaque) return kOpaque;
    const auto [found, is_new] = index_.try_emplace({material_index, vertexAlpha(triangle)}, index_.size());
    if (is_new) {
      if (index_.size() > kOpaque)
        throw InputError(scene_.file, material.gltf_path, "more than 65535 different transparencies (material and vertex alpha)");
      describe(material, found->first.second / 255.0f);
    }
    return uint16_t(found->second);
  }
  const v1::AlphaMaterials& materials() const { return materials_; }
  /// Scene texture of each chunk "alpha_texture_<i>".
  const std::vector<uint32_t>& textures() const { return textures_; }

 private:
  /// Mean over the corners, in 1/255: the container keeps one factor for each triangle.
  int vertexAlpha(uint32_t triangle) const {
    if (scene_.mesh.colors.empty()) return 255;
    float sum = 0;
    for (const uint32_t vertex : scene_.mesh.triangles[triangle]) sum += scene_.mesh.colors[vertex][3];
    return int(std::clamp(sum / 3.0f, 0.0f, 1.0f) * 255.0f + 0.5f);
  }
  void describe(const scene::Material& material, float vertex_alpha) {
    v1::AlphaMaterial* out = materials_.add_materials();
    out->set_mode(material.alpha_mode == scene::AlphaMode::mask ? v1::ALPHA_MODE_MASK : v1::ALPHA_MODE_BLEND);
    if (material.alpha_mode == scene::AlphaMode::mask) out->set_cutoff(material.alpha_cutoff);
    out->set_factor(material.alpha * vertex_alpha);
    if (material.base_color_texture == kNone) return;
    const auto [found, is_new] = texture_index_.try_emplace(material.base_color_texture, uint32_t(textures_.size()));
    if (is_new) textures_.push_back(material.base_color_texture);
    const scene::Texture& texture = scene_.textures[material.base_color_texture];
    out->set_texture(found->second);
    out->set_wrap_u(wrapMode(texture.wrap_u));
    out->set_wrap_v(wrapMode(texture.wrap_v));
  }

  const scene::Scene& scene_;
  std::map<std::pair<uint32_t, int>, size_t> index_;
  std::map<uint32_t, uint32_t> texture_index_;
  std::vector<uint32_t> textures_;
  v1::AlphaMaterials materials_;
};

std::vector<float> flatten(const std::vector<Vec2>& values, size_t count) {
  std::vector<float> flat(count * 2, 0.0f);
  for (size_t i = 0; i < values.size(); ++i) flat[2 * i] = values[i].x, flat[2 * i + 1] = values[i].y;
  return flat;
}

}  // namespace

void addGeometrySection(format::Writer& writer, const scene::Scene& scene, const atlas::Atlas& atlas) {
  const scene::Mesh& mesh = scene.mesh;
  const uint64_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
  std::vector<float> position;
  std::vector<int16_t> normal;
  position.reserve(vertices * 3);
  normal.reserve(vertices * 2);
  for (uint64_t v = 0; v < vertices; ++v) {
    for (int i = 0; i < 3; ++i) position.push_back(float(mesh.positions[v][i] * scene.metres_per_unit));
    const auto oct = format::packOct({mesh.normals[v].x, mesh.normals[v].y, mesh.normals[v].z});
    normal.push_back(oct.x);
    normal.push_back(oct.y);
  }
  std::vector<uint32_t> index;
  index.reserve(triangles * 3);
  std::vector<uint8_t> flags;
  std::vector<uint16_t> alpha;
  AlphaTable alpha_table(scene);
  for (uint32_t t = 0; t < triangles; ++t) {
    index.insert(index.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
    const scene::Material& material = scene.materials[mesh.triangle_material[t]];
    flags.push_back(uint8_t(material.double_sided) | (material.alpha_mode == scene::AlphaMode::mask) << 1 |
                    (material.alpha_mode == scene::AlphaMode::blend) << 2);
    alpha.push_back(alpha_table.add(t));
  }
  writer.addSection("geometry");
  writer.add("geometry", "position", position, {vertices, 3});
  writer.add("geometry", "normal", normal, {vertices, 2});
  writer.add("geometry", "lightmap_uv", flatten(atlas.uv, vertices), {vertices, 2});
  writer.add("geometry", "index", index, {triangles, 3});
  writer.add("geometry", "triangle_flags", flags);
  if (alpha_table.materials().materials_size() == 0) return;
  writer.add("geometry", "alpha_uv", flatten(mesh.base_uv, vertices), {vertices, 2});
  writer.add("geometry", "triangle_alpha", alpha);
  writer.addMessage("geometry", "alpha_material", alpha_table.materials());
  for (size_t i = 0; i < alpha_table.textures().size(); ++i) {
    const scene::Texture& texture = scene.textures[alpha_table.textures()[i]];
    std::vector<uint8_t> values(size_t(texture.width) * texture.height);
    for (size_t p = 0; p < values.size(); ++p) values[p] = texture.rgba[4 * p + 3];
    writer.add("geometry", "alpha_texture_" + std::to_string(i), values, {uint64_t(texture.height), uint64_t(texture.width)});
  }
}

}  // namespace lightwell::bake
