// Spheres of several shininess under a sky: the game's side of environment light, from the depth maps to the shader.
#pragma once
#include <memory>
#include <vector>

#include "lightwell/lightwell_gl.h"
#include "render/gl_objects.h"
#include "render/png.h"
#include "render/render_target.h"

namespace lightwell::samples {

enum class Lobe { phong, ggx };

struct SphereSettings {
  uint32_t technique = LW_ENVIRONMENT_SHARE;  // LW_ENVIRONMENT_…
  uint32_t cells = 0;                         // 0: all
  uint32_t map_texels = 256, sun_map_texels = 1024;
  Lobe lobe = Lobe::ggx;
  int width = 960, height = 400;
};

/// The scene sky_spheres and a ball that flies over it. Throws render::RenderError.
class SphereView {
 public:
  SphereView(lw_gl* gl, const lw_environment* environment, const SphereSettings& settings);

  /// Where the ball is: once around for t from 0 to 1. Its shadows follow as the maps are drawn.
  void moveBall(float t);
  /// Draws at most so many depth maps.
  void refresh(uint32_t most_maps);
  uint32_t cells() const;
  render::Image8 draw() const;

 private:
  struct Part {
    GLint first_vertex;
    GLsizei vertices;
    render::Float3 albedo_rgb;
    float roughness;
    bool moves;
  };
  struct Destroy {
    void operator()(lw_gl_environment* environment) const { lw_gl_environment_destroy(environment); }
  };
  void addScene();
  void drawParts(const render::Program& program) const;

  SphereSettings settings_;
  float exposure_ = 1;
  std::unique_ptr<lw_gl_environment, Destroy> environment_;
  render::Program depth_program_, surface_program_, background_program_, tone_map_program_;
  render::VertexArray vertex_array_, no_attributes_;
  render::Buffer buffer_;
  std::vector<Part> parts_;
  render::Float3 ball_m_{0, 0, 0};
  mutable render::RenderTarget target_;
};

}  // namespace lightwell::samples
