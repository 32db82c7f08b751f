// Materials and the textures that their base colour and emission use.
#pragma once
#include <map>
#include <optional>
#include <tuple>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/gltf/document.h"
#include "precompute/scene/gltf/primitive.h"
#include "precompute/scene/scene.h"

namespace lightwell::scene::gltf {

/// A material, and the coordinates with which its textures are looked up.
struct ImportedMaterial {
  Material material;
  std::optional<TextureCoordinates> base_coordinates, emissive_coordinates;
};

/// Turns the materials and textures of a document into those of a scene, as they are asked for: unused ones are never read.
class MaterialImporter {
 public:
  MaterialImporter(Document& document, std::vector<Texture>& textures, Diagnostics& diagnostics)
      : document_(document), textures_(textures), diagnostics_(diagnostics) {}

  /// Reads material `index` (Primitive::kNoMaterial: the default material of glTF). Core PBR factors, KHR_materials_emissive_strength,
  /// KHR_materials_unlit, the diffuse half of KHR_materials_pbrSpecularGlossiness, KHR_texture_transform, EXT_texture_webp.
  ImportedMaterial import(size_t index);

 private:
  uint32_t importTexture(const JsonValue& texture_info, std::optional<TextureCoordinates>& coordinates);
  uint32_t decodeTexture(size_t image, Texture::Wrap wrap_u, Texture::Wrap wrap_v);
  void importEmission(const JsonValue& json, ImportedMaterial& result);
  void importAlpha(const JsonValue& json, Material& material);
  std::array<double, 4> unitFactor(const JsonValue& json, std::string_view key);

  Document& document_;
  std::vector<Texture>& textures_;
  Diagnostics& diagnostics_;
  std::map<std::tuple<size_t, Texture::Wrap, Texture::Wrap>, uint32_t> texture_of_;
  uint64_t pixels_ = 0;
};

}  // namespace lightwell::scene::gltf
