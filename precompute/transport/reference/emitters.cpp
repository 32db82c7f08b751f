#include "precompute/transport/reference/emitters.h"

#include <algorithm>
#include <array>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr uint32_t kMaxDivisions = 32;
constexpr float kTexelsPerPiece = 4;  // edge of a piece, before kMaxDivisions limits it
constexpr int kPowerSamples = 4;      // per edge of the grid over a piece

/// Piece `index` of a triangle whose edges are divided into `n`: rows of constant v, upright and inverted pieces alternating.
struct Piece {
  float u0, v0, step;  // corner and signed edge: corners (u0, v0), (u0 + step, v0), (u0, v0 + step)
};
Piece pieceAt(uint32_t n, uint32_t index) {
  uint32_t row = 0;
  while (index >= 2 * (n - row) - 1) index -= 2 * (n - row++) - 1;
  const float step = 1.0f / float(n);
  const uint32_t column = index / 2;
  if (index % 2 == 0) return {float(column) * step, float(row) * step, step};
  return {float(column + 1) * step, float(row + 1) * step, -step};
}

uint32_t pieceUnder(uint32_t n, float u, float v) {
  const float scaled_u = u * float(n), scaled_v = v * float(n);
  const uint32_t row = std::min(uint32_t(std::max(scaled_v, 0.0f)), n - 1);
  const uint32_t column = std::min(uint32_t(std::max(scaled_u, 0.0f)), n - 1 - row);
  const bool inverted = (scaled_u - float(column)) + (scaled_v - float(row)) > 1.0f && column + row + 1 < n;
  return row * (2 * n - row) + 2 * column + (inverted ? 1 : 0);
}

/// How finely the emission of a triangle varies: the number of parts into which its edges are cut.
uint32_t divisionsFor(const scene::Scene& scene, uint32_t triangle) {
  const scene::Material& material = scene.materials[scene.mesh.triangle_material[triangle]];
  if (material.emissive_texture == kNone || scene.mesh.emissive_uv.empty()) return 1;
  const scene::Texture& texture = scene.textures[material.emissive_texture];
  const auto& corner = scene.mesh.triangles[triangle];
  float texels = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec2 edge = scene.mesh.emissive_uv[corner[(i + 1) % 3]] - scene.mesh.emissive_uv[corner[i]];
    texels = std::max(texels, std::hypot(edge.x * float(texture.width), edge.y * float(texture.height)));
  }
  return uint32_t(std::clamp(std::ceil(texels / kTexelsPerPiece), 1.0f, float(kMaxDivisions)));
}

/// Mean luminance, times alpha, over a piece, from a regular grid of points (exact for a constant emission).
float meanLuminance(const scene::Scene& scene, uint32_t triangle, const Piece& piece) {
  double sum = 0;
  for (int j = 0; j < kPowerSamples; ++j)
    for (int i = 0; i < kPowerSamples; ++i) {
      const Vec2 b = sampleTriangle({(float(i) + 0.5f) / kPowerSamples, (float(j) + 0.5f) / kPowerSamples});
      const scene::SurfaceColor color = scene::surfaceColor(scene, triangle, piece.u0 + b.x * piece.step, piece.v0 + b.y * piece.step);
      sum += luminance(color.emitted_radiance_rgb) * color.alpha;
    }
  return float(sum / (kPowerSamples * kPowerSamples));
}

}  // namespace

Emitters::Emitters(const scene::Scene& scene) : scene_(scene) {
  const scene::Mesh& mesh = scene.mesh;
  std::vector<LightBounds> pieces;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const scene::Material& material = scene.materials[mesh.triangle_material[t]];
    if (!(maxComponent(material.emissive) > 0.0f)) continue;
    const std::array<Vec3, 3> p = {mesh.positions[mesh.triangles[t][0]], mesh.positions[mesh.triangles[t][1]],
                                   mesh.positions[mesh.triangles[t][2]]};
    const Vec3 cross = (p[1] - p[0]).cross(p[2] - p[0]);
    const float area = 0.5f * cross.length();
    if (!(area > 0.0f)) continue;
    const Triangle emitter{t, uint32_t(pieces.size()), divisionsFor(scene, t), area, cross.normalized()};
    const uint32_t count = emitter.divisions * emitter.divisions;
    for (uint32_t i = 0; i < count; ++i) {
      const Piece piece = pieceAt(emitter.divisions, i);
      LightBounds bounds;
      for (const auto& [u, v] : {std::pair{piece.u0, piece.v0}, {piece.u0 + piece.step, piece.v0}, {piece.u0, piece.v0 + piece.step}})
        bounds.box.extendBy(p[0] + (p[1] - p[0]) * u + (p[2] - p[0]) * v);
      bounds.axis = emitter.geometric_normal;
      bounds.emission_spread = kPi / 2;
      bounds.two_sided = material.double_sided;
      bounds.power = area / float(count) * meanLuminance(scene, t, piece);
      pieces.push_back(bounds);
    }
    piece_emitter_.resize(pieces.size(), uint32_t(triangles_.size()));
    if (triangle_emitter_.empty()) triangle_emitter_.assign(mesh.triangles.size(), kNone);
    triangle_emitter_[t] = uint32_t(triangles_.size());
    triangles_.push_back(emitter);
  }
  tree_ = LightTree(pieces);
}

std::optional<Emitters::Sample> Emitters::sample(const Vec3& position, const Vec3& normal, float u_pick, const Vec2& u_place) const {
  const LightTree::Pick pick = tree_.pick(position, normal, u_pick);
  if (pick.item == kNone || !(pick.probability > 0.0f)) return std::nullopt;
  const Triangle& emitter = triangles_[piece_emitter_[pick.item]];
  const Piece piece = pieceAt(emitter.divisions, pick.item - emitter.first_piece);
  const Vec2 b = sampleTriangle(u_place);
  const float u = piece.u0 + b.x * piece.step, v = piece.v0 + b.y * piece.step;
  const auto& corner = scene_.mesh.triangles[emitter.triangle];
  const auto& p = scene_.mesh.positions;
  Sample sample;
  sample.triangle = emitter.triangle;
  sample.position = p[corner[0]] * (1.0f - u - v) + p[corner[1]] * u + p[corner[2]] * v;
  sample.geometric_normal = emitter.geometric_normal;
  sample.radiance_rgb = scene::surfaceColor(scene_, emitter.triangle, u, v).emitted_radiance_rgb;
  sample.pdf_area = pick.probability * float(emitter.divisions * emitter.divisions) / emitter.area;
  sample.double_sided = scene_.materials[scene_.mesh.triangle_material[emitter.triangle]].double_sided;
  return sample;
}

float Emitters::pdfArea(uint32_t triangle, float u, float v, const Vec3& position, const Vec3& normal) const {
  if (triangle_emitter_.empty() || triangle_emitter_[triangle] == kNone) return 0.0f;
  const Triangle& emitter = triangles_[triangle_emitter_[triangle]];
  const uint32_t piece = emitter.first_piece + pieceUnder(emitter.divisions, u, v);
  return tree_.probability(piece, position, normal) * float(emitter.divisions * emitter.divisions) / emitter.area;
}

}  // namespace lightwell::transport
