#include "precompute/scene/gltf/materials.h"

#include <algorithm>
#include <cmath>

#include "precompute/scene/gltf/files.h"
#include "precompute/scene/gltf/image.h"
#include "precompute/scene/gltf/limits.h"

namespace lightwell::scene::gltf {
namespace {

constexpr double kMaxRadiance = 1e20;  // keeps sums over a whole scene inside a float

Texture::Wrap wrapMode(const JsonValue& sampler, const char* key) {
  switch (sampler.unsignedOr(key, 10497)) {
    case 10497: return Texture::Wrap::repeat;
    case 33071: return Texture::Wrap::clamp;
    case 33648: return Texture::Wrap::mirror;
    default: sampler.at(key).fail("is no wrapping mode");
  }
}

TextureCoordinates readCoordinates(const JsonValue& texture_info) {
  TextureCoordinates result;
  result.set = texture_info.unsignedOr("texCoord", 0);
  if (const auto transform = texture_info.extension("KHR_texture_transform")) {
    result.set = transform->unsignedOr("texCoord", result.set);
    result.offset = transform->numbersOr<2>("offset", result.offset);
    result.scale = transform->numbersOr<2>("scale", result.scale);
    result.rotation = transform->numberOr("rotation", 0);
  }
  return result;
}

}  // namespace

uint32_t MaterialImporter::decodeTexture(size_t image_index, Texture::Wrap wrap_u, Texture::Wrap wrap_v) {
  const auto key = std::make_tuple(image_index, wrap_u, wrap_v);
  if (const auto known = texture_of_.find(key); known != texture_of_.end()) return known->second;
  const JsonValue json = document_.element("images", image_index);
  std::vector<uint8_t> file;
  std::span<const uint8_t> bytes;
  if (const auto uri = json.find("uri")) {
    file = document_.external(*uri);
    bytes = file;
  } else {
    bytes = document_.view(json.at("bufferView")).bytes;
  }
  Image image;
  std::string reason;
  if (!decodeImage(bytes, kMaxTexturePixels - pixels_, image, reason)) json.fail(reason);
  pixels_ += uint64_t(image.width) * uint64_t(image.height);
  textures_.push_back({image.width, image.height, std::move(image.rgba), wrap_u, wrap_v});
  const auto index = uint32_t(textures_.size() - 1);
  texture_of_.emplace(key, index);
  return index;
}

uint32_t MaterialImporter::importTexture(const JsonValue& texture_info, std::optional<TextureCoordinates>& coordinates) {
  const JsonValue texture = document_.element("textures", texture_info.at("index"));
  auto source = texture.find("source");
  if (const auto webp = texture.extension("EXT_texture_webp")) source = webp->at("source");
  if (!source) {
    diagnostics_.warn(texture.path(), "has no picture in a known format; the texture is left out");
    return kNone;
  }
  const size_t image = source->index(document_.count("images"), "images");
  Texture::Wrap wrap_u = Texture::Wrap::repeat, wrap_v = Texture::Wrap::repeat;
  if (const auto reference = texture.find("sampler")) {
    const JsonValue sampler = document_.element("samplers", *reference);
    wrap_u = wrapMode(sampler, "wrapS");
    wrap_v = wrapMode(sampler, "wrapT");
  }
  coordinates = readCoordinates(texture_info);
  return decodeTexture(image, wrap_u, wrap_v);
}

/// Four factors in [0, 1], opaque white when absent; others are clamped with a warning.
std::array<double, 4> MaterialImporter::unitFactor(const JsonValue& json, std::string_view key) {
  auto factor = json.numbersOr<4>(key, {1, 1, 1, 1});
  bool clamped = false;
  for (double& f : factor) {
    clamped = clamped || f < 0 || f > 1;
    f = std::clamp(f, 0.0, 1.0);
  }
  if (clamped) diagnostics_.warn(json.path() + "." + std::string(key), "is outside [0, 1]; clamped");
  return factor;
}

void MaterialImporter::importEmission(const JsonValue& json, ImportedMaterial& result) {
  if (result.material.unlit) return;  // shown as it is; it lights nothing
  const auto factor = json.numbersOr<3>("emissiveFactor", {0, 0, 0});
  double strength = 1;
  if (const auto extension = json.extension("KHR_materials_emissive_strength")) strength = extension->numberOr("emissiveStrength", 1);
  bool negative = false;
  for (size_t c = 0; c < 3; ++c) {
    const double radiance = factor[c] * strength;
    negative = negative || radiance < 0;
    if (radiance > kMaxRadiance)
      json.at("emissiveFactor").fail("gives an absurd radiance of " + std::to_string(radiance));
    result.material.emissive[int(c)] = float(std::max(radiance, 0.0));
  }
  if (negative) diagnostics_.warn(json.path() + ".emissiveFactor", "is negative; taken as zero");
  if (result.material.emissive == Rgb(0)) return;
  if (const auto texture = json.find("emissiveTexture"))
    result.material.emissive_texture = importTexture(*texture, result.emissive_coordinates);
}

void MaterialImporter::importAlpha(const JsonValue& json, Material& material) {
  const std::string mode = json.stringOr("alphaMode", "OPAQUE");
  if (mode == "OPAQUE") material.alpha_mode = AlphaMode::opaque;
  else if (mode == "MASK") material.alpha_mode = AlphaMode::mask;
  else if (mode == "BLEND") material.alpha_mode = AlphaMode::blend;
  else json.at("alphaMode").fail("is \"" + mode + "\", which is no alpha mode");
  material.alpha_cutoff = float(json.numberOr("alphaCutoff", 0.5));
}

ImportedMaterial MaterialImporter::import(size_t index) {
  ImportedMaterial result;
  Material& material = result.material;
  if (index == Primitive::kNoMaterial) {
    material.name = "(default material)";
    material.gltf_path = "materials";
    return result;
  }
  const JsonValue json = document_.element("materials", index);
  material.gltf_path = json.path();
  material.name = json.stringOr("name", "");
  material.unlit = json.extension("KHR_materials_unlit").has_value();
  material.double_sided = json.booleanOr("doubleSided", false);
  importAlpha(json, material);

  auto colors = json.find("pbrMetallicRoughness");
  const char *factor_key = "baseColorFactor", *texture_key = "baseColorTexture";
  if (const auto glossiness = json.extension("KHR_materials_pbrSpecularGlossiness")) {
    colors = glossiness;
    factor_key = "diffuseFactor";
    texture_key = "diffuseTexture";
  }
  if (colors) {
    const auto factor = unitFactor(*colors, factor_key);
    material.base_color = Rgb(float(factor[0]), float(factor[1]), float(factor[2]));
    material.alpha = float(factor[3]);
    if (const auto texture = colors->find(texture_key)) material.base_color_texture = importTexture(*texture, result.base_coordinates);
  }
  importEmission(json, result);
  return result;
}

}  // namespace lightwell::scene::gltf
