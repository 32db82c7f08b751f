// Colours of surfaces: textures, factors and vertex colours.
#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/scene/scene.h"

namespace lightwell::scene {
namespace {

constexpr float kMaxAlbedo = 0.999f;

/// IEC 61966-2-1, for the 256 codes.
const std::array<float, 256>& srgbTable() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> result{};
    for (size_t i = 0; i < 256; ++i) {
      const double encoded = double(i) / 255.0;
      result[i] = float(encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4));
    }
    return result;
  }();
  return table;
}

/// The texel that the integer coordinate `i` (within one period of the borders) addresses.
int wrap(long long i, int size, Texture::Wrap mode) {
  if (mode == Texture::Wrap::clamp) return int(std::clamp<long long>(i, 0, size - 1));
  const long long period = mode == Texture::Wrap::mirror ? 2LL * size : size;
  i %= period;
  if (i < 0) i += period;
  return int(i < size ? i : period - 1 - i);
}

struct Taps {
  int texel[2];
  float weight;  // of texel[1]
};

/// The two texels on either side of a coordinate. Texel centres lie at half-integers.
Taps taps(float coordinate, int size, Texture::Wrap mode) {
  if (!std::isfinite(coordinate)) coordinate = 0;
  const double place = std::clamp(double(coordinate), -1e9, 1e9) * size - 0.5;
  const double first = std::floor(place);
  const auto i = static_cast<long long>(first);
  return {{wrap(i, size, mode), wrap(i + 1, size, mode)}, float(place - first)};
}

/// The attribute of a triangle's corners at barycentrics (1 − u − v, u, v).
template <typename T>
T interpolate(const std::vector<T>& attribute, const std::array<uint32_t, 3>& corners, float u, float v) {
  return attribute[corners[0]] * (1 - u - v) + attribute[corners[1]] * u + attribute[corners[2]] * v;
}

std::array<float, 4> vertexColor(const Mesh& mesh, const std::array<uint32_t, 3>& corners, float u, float v) {
  std::array<float, 4> result{1, 1, 1, 1};
  if (mesh.colors.empty()) return result;
  for (size_t c = 0; c < 4; ++c)
    result[c] = mesh.colors[corners[0]][c] * (1 - u - v) + mesh.colors[corners[1]][c] * u + mesh.colors[corners[2]][c] * v;
  return result;
}

float effectiveAlpha(const Material& material, float alpha) {
  switch (material.alpha_mode) {
    case AlphaMode::opaque: return 1;
    case AlphaMode::mask: return alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
    case AlphaMode::blend: return std::clamp(alpha, 0.0f, 1.0f);
  }
  return 1;
}

}  // namespace

std::array<float, 4> sampleTexture(const Texture& texture, const Vec2& uv) {
  const Taps x = taps(uv.x, texture.width, texture.wrap_u), y = taps(uv.y, texture.height, texture.wrap_v);
  const auto& to_linear = srgbTable();
  std::array<float, 4> result{0, 0, 0, 0};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const float weight = (i ? x.weight : 1 - x.weight) * (j ? y.weight : 1 - y.weight);
      const uint8_t* texel = texture.rgba.data() + (size_t(y.texel[j]) * size_t(texture.width) + size_t(x.texel[i])) * 4;
      for (size_t c = 0; c < 3; ++c) result[c] += weight * to_linear[texel[c]];
      result[3] += weight * (float(texel[3]) / 255.0f);
    }
  return result;
}

SurfaceColor surfaceColor(const Scene& scene, uint32_t triangle, float u, float v) {
  const Mesh& mesh = scene.mesh;
  const auto& corners = mesh.triangles[triangle];
  const Material& material = scene.materials[mesh.triangle_material[triangle]];
  const auto vertex_color = vertexColor(mesh, corners, u, v);
  std::array<float, 4> base{1, 1, 1, 1};
  if (material.base_color_texture != kNone)
    base = sampleTexture(scene.textures[material.base_color_texture], interpolate(mesh.base_uv, corners, u, v));
  SurfaceColor result;
  for (int c = 0; c < 3; ++c)
    result.albedo_rgb[c] = std::clamp(material.base_color[c] * base[size_t(c)] * vertex_color[size_t(c)], 0.0f, kMaxAlbedo);
  result.emitted_radiance_rgb = material.emissive;
  if (material.emissive_texture != kNone) {
    const auto emission = sampleTexture(scene.textures[material.emissive_texture], interpolate(mesh.emissive_uv, corners, u, v));
    for (int c = 0; c < 3; ++c) result.emitted_radiance_rgb[c] *= emission[size_t(c)];
  }
  result.alpha = effectiveAlpha(material, material.alpha * base[3] * vertex_color[3]);
  return result;
}

float surfaceAlpha(const Scene& scene, uint32_t triangle, float u, float v) {
  const Mesh& mesh = scene.mesh;
  const Material& material = scene.materials[mesh.triangle_material[triangle]];
  if (material.alpha_mode == AlphaMode::opaque) return 1;
  const auto& corners = mesh.triangles[triangle];
  float alpha = material.alpha * vertexColor(mesh, corners, u, v)[3];
  if (material.base_color_texture != kNone)
    alpha *= sampleTexture(scene.textures[material.base_color_texture], interpolate(mesh.base_uv, corners, u, v))[3];
  return effectiveAlpha(material, alpha);
}

}  // namespace lightwell::scene
