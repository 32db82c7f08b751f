// One mesh primitive in its own coordinates: vertex attributes and triangles, whatever the file encodes them as.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/core/math.h"
#include "precompute/scene/gltf/document.h"

namespace lightwell::scene::gltf {

/// Texture coordinates of vertices that a material wants: the set and KHR_texture_transform.
struct TextureCoordinates {
  size_t set = 0;  // TEXCOORD_n
  std::array<double, 2> offset{0, 0}, scale{1, 1};
  double rotation = 0;  // radians, counter-clockwise
  /// KHR_texture_transform: translation * rotation * scale; rotated counter-clockwise as seen with v pointing down, which is what
  /// the extension's example (the lower left quadrant) and its renderers do.
  Vec2 apply(const Vec2& uv) const;
};

/// All vertex arrays are as long as `positions`, or empty when the file has none.
struct Primitive {
  std::string path;                // meshes[3].primitives[0]
  size_t material;                 // index into materials; kNoMaterial
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;       // unit
  std::vector<Vec2> base_uv, emissive_uv;  // as the material's textures want them
  std::vector<Vec2> lightmap_uv;   // TEXCOORD_1
  std::vector<std::array<float, 4>> colors;
  std::vector<std::array<uint32_t, 3>> triangles;  // every index < positions.size()
  static constexpr size_t kNoMaterial = ~size_t(0);
};

/// The texture coordinates that a material's textures use; null when it has no such texture.
struct WantedCoordinates {
  const TextureCoordinates* base = nullptr;
  const TextureCoordinates* emissive = nullptr;
};

/// The material index of a primitive, checked; Primitive::kNoMaterial when absent.
size_t materialIndex(const Document& document, const JsonValue& primitive);

/// True for the modes TRIANGLES, TRIANGLE_STRIP and TRIANGLE_FAN. An unknown mode is an InputError.
bool isSurface(const JsonValue& primitive);

/// Reads a surface primitive. `weights` are the morph target weights of the rest pose. Throws InputError naming the place.
Primitive readPrimitive(Document& document, const JsonValue& primitive, const WantedCoordinates& wanted, const std::vector<double>& weights,
                        Diagnostics& diagnostics);

}  // namespace lightwell::scene::gltf
