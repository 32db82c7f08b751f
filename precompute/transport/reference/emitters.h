// The emissive triangles of a scene as lights that can be sampled by area.
#pragma once
#include <optional>
#include <vector>

#include "precompute/scene/scene.h"
#include "precompute/transport/reference/light_tree.h"

namespace lightwell::transport {

/// Picks points on emissive triangles by power, texture included, distance and orientation; the density can be evaluated at any hit.
/// Triangles whose emission is textured are divided regularly, so that a small lamp painted on a large wall is found.
class Emitters {
 public:
  /// `scene` must outlive this and not change.
  explicit Emitters(const scene::Scene& scene);

  bool empty() const { return tree_.empty(); }

  struct Sample {
    uint32_t triangle;
    Vec3 position, geometric_normal;  // internal units; front side
    Rgb radiance_rgb;                 // emitted; alpha is not in it
    float pdf_area;                   // per internal unit², > 0
    bool double_sided;
  };
  /// A point for a receiver at `position` with unit normal `normal`; none when no emitter can shine on it. All u in [0, 1).
  std::optional<Sample> sample(const Vec3& position, const Vec3& normal, float u_pick, const Vec2& u_place) const;
  /// The density of `sample` at (u, v) of `triangle`, per internal unit². Zero where nothing is emitted.
  float pdfArea(uint32_t triangle, float u, float v, const Vec3& position, const Vec3& normal) const;

 private:
  struct Triangle {
    uint32_t triangle, first_piece, divisions;  // divisions² pieces
    float area;                                 // internal units²
    Vec3 geometric_normal;
  };
  const scene::Scene& scene_;
  std::vector<Triangle> triangles_;
  std::vector<uint32_t> triangle_emitter_;  // scene triangle to index into triangles_; kNone
  std::vector<uint32_t> piece_emitter_;     // piece to index into triangles_
  LightTree tree_;                          // over the pieces
};

}  // namespace lightwell::transport
