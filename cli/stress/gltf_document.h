// A glTF scene under construction, for cases that no modelling program would write.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::stress {

/// How a surface looks. `holes`: alpha is 0 on every other of so many vertical stripes along s of each quad, cut out by alpha mask; 0: opaque.
struct Look {
  Rgb albedo_rgb{0.5f, 0.5f, 0.5f};
  Rgb emitted_radiance_rgb{0, 0, 0};
  bool double_sided = false;
  uint32_t holes = 0;
};

/// A point light (candela), or one from far away along `direction` (lux).
struct Lamp {
  bool directional = false;
  Vec3d position_m{0, 0, 0};
  Vec3d direction{0, -1, 0};
  double intensity = 1;
};

/// Where a whole document is put: p → scale p + translation, x mirrored before.
struct Placement {
  double scale = 1;
  Vec3d translation_m{0, 0, 0};
  bool mirrored = false;
  bool by_nodes = false;  // by the nodes' transforms; else the vertices themselves are elsewhere
};

/// Lengths in metres, in double precision until the file is written. Quads are two triangles with four vertices of their own.
class GltfDocument {
 public:
  uint32_t material(const Look& look);
  /// The parallelogram origin + s edge_s + t edge_t, s and t in [0, 1]; its front is the side of edge_s × edge_t.
  void quad(const Vec3d& origin, const Vec3d& edge_s, const Vec3d& edge_t, uint32_t material);
  /// Fronts are counter-clockwise.
  void triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, uint32_t material);
  /// The same quad as count_s × count_t quads that share vertices.
  void grid(const Vec3d& origin, const Vec3d& edge_s, const Vec3d& edge_t, uint32_t count_s, uint32_t count_t, uint32_t material);
  /// Six walls, fronts inward or outward.
  void box(const Vec3d& low, const Vec3d& high, uint32_t material, bool fronts_inward);
  void lamp(const Lamp& lamp) { lamps_.push_back(lamp); }
  /// Gives all quads light-map coordinates of their own: squares side by side in the corner of the atlas that is `part` of its width. Only for scenes of quads.
  void layOut(double part);

  size_t triangleCount() const;
  /// Square metres, as written with a scale of 1.
  double area_m2() const;
  void place(const Placement& placement) { placement_ = placement; }
  /// One more instance of all surfaces: a node of the same mesh, x mirrored before. Not for documents that are placed by vertices or laid out.
  void repeat(const Vec3d& translation_m, bool mirrored) { instances_.push_back({1, translation_m, mirrored, true}); }
  void write(const std::filesystem::path& glb) const;

 private:
  struct Surface {  // of one material
    std::vector<Vec3d> positions_m;
    std::vector<Vec2> uv, lightmap_uv;
    std::vector<std::array<uint32_t, 3>> triangles;
  };
  std::vector<Look> looks_;
  std::vector<Surface> surfaces_;  // by material
  std::vector<Lamp> lamps_;
  Placement placement_;
  std::vector<Placement> instances_;  // further ones
};

}  // namespace lightwell::stress
