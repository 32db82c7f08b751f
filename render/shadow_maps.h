// Depth maps of the lights, in the form that both the direct light of the picture and lw_gl_update_entries read.
#pragma once
#include <span>
#include <vector>

#include "lightwell/lightwell_gl.h"
#include "render/scene_mesh.h"

namespace lightwell::render {

/// The depth map of one light. Its lw_gl_light says how to read it.
struct ShadowMap {
  lw_gl_light light;       // complete: shadow kind, texture, matrix, planes, biases
  Texture texture;
  int resolution = 0;      // texels per side
  float texel_slope = 0;   // width of a texel, metres, per metre of distance (point, spot), or simply in metres (directional)
};

class ShadowMaps {
 public:
  explicit ShadowMaps(const SceneMesh& mesh);

  /// Makes one map per light; those whose light has not moved are kept. Surfaces cast from both sides, cut-outs exactly, blended surfaces
  /// where their alpha is at least one half.
  void update(std::span<const lw_light> lights);
  std::span<const ShadowMap> maps() const { return maps_; }

 private:
  ShadowMap render(const lw_light& light, int resolution) const;
  void renderCube(ShadowMap& map) const;
  void render2D(ShadowMap& map) const;
  void drawDepth(const Matrix4& view_projection) const;

  const SceneMesh& mesh_;
  Program program_;
  Framebuffer framebuffer_;
  std::vector<ShadowMap> maps_;
};

}  // namespace lightwell::render
