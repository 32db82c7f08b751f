// The surfaces of a container on the GPU: one vertex array, drawn in runs of triangles with equal state.
#pragma once
#include <vector>

#include "lightwell/lightwell.h"
#include "render/gl_objects.h"

namespace lightwell::render {

/// The leaf of a door, and how far it is open: what is left of it is where axis_per_m · position + offset ≥ open.
struct Leaf {
  uint32_t first_triangle = 0, triangle_count = 0;  // of the container's
  float axis_per_m[3] = {}, offset = 0;
  float open = 0;
};

class SceneMesh {
 public:
  /// Decodes geometry and atlas colours. A container without geometry gives an empty mesh. Throws RenderError.
  explicit SceneMesh(const lw_container* container, std::vector<Leaf> leaves = {});

  enum class Kind { solid, blended };
  /// Draws what is solid (opaque and cut out) or blended, with `program` in use. Sets its alpha uniforms (kAlphaGlsl) on texture unit
  /// `alpha_unit`. `cull`: single-sided surfaces show their front only.
  void draw(Kind kind, const Program& program, int alpha_unit, bool cull) const;

  GLuint albedoAtlas() const { return albedo_; }      // sRGB format: lookups are linear
  GLuint emissionAtlas() const { return emission_; }  // radiance; one black texel when nothing emits
  const lw_scene_info& info() const { return info_; }
  /// Length of the bounds' diagonal, metres; 1 without surfaces.
  float diagonal_m() const { return diagonal_m_; }
  /// Distance to the farthest corner of the bounds.
  float farthest_m(const Float3& from) const;
  Float3 center_m() const { return center_m_; }

 private:
  struct Batch {
    uint8_t flags;             // LW_TRIANGLE_…
    uint16_t alpha_material;   // index, or 0xffff
    uint32_t leaf;             // index into leaves_, or their number
    uint32_t first_triangle, triangle_count;
  };
  struct AlphaMaterial {
    lw_alpha_material values;
    Texture texture;  // of linear alpha; 0 without one
  };
  void loadGeometry(const lw_container* container);
  void loadAtlas(const lw_container* container);
  void loadAlphaMaterials(const lw_container* container, const std::vector<uint16_t>& triangle_alpha);

  std::vector<Leaf> leaves_;
  lw_scene_info info_{};
  Float3 center_m_{};
  float diagonal_m_ = 1;
  VertexArray vertex_array_;
  std::vector<Buffer> buffers_;
  std::vector<Batch> batches_;
  std::vector<AlphaMaterial> alpha_materials_;
  Texture albedo_, emission_, opaque_;
};

}  // namespace lightwell::render
