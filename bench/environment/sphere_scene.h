// A sphere on a plane under a sky on OpenGL, and the light on the plane: what shadowed environment light is measured with.
#pragma once
#include <epoxy/gl.h>

#include <memory>
#include <vector>

#include "lightwell/lightwell_gl.h"
#include "precompute/transport/environment/environment.h"
#include "render/gl_objects.h"

namespace lightwell::bench {

inline constexpr float kSphereRadius_m = 0.5f, kPlaneHalf_m = 2.0f;  // the sphere rests on the plane's middle, the origin

class SphereScene {
 public:
  /// Makes the programs in the current context. Throws render::RenderError.
  SphereScene();
  ~SphereScene();

  /// Uploads an environment and draws all depth maps. Throws render::RenderError.
  void setSky(const transport::Environment& environment, uint32_t map_texels);
  /// Irradiance on the plane, [side][side][4]; texel (x, z) lies at plane coordinates ((x + 0.5) / side · 2 − 1) · kPlaneHalf_m.
  std::vector<float> planeIrradiance(int side, uint32_t technique);
  /// The same without reading back: for measuring time. With `lobe` also a GGX lobe of roughness 0.3.
  void drawPlane(int side, uint32_t technique, bool lobe);
  void drawMaps(uint32_t count);
  uint32_t cells() const;

 private:
  struct Destroy {
    void operator()(lw_gl* gl) const { lw_gl_destroy(gl); }
    void operator()(lw_gl_environment* environment) const { lw_gl_environment_destroy(environment); }
  };
  std::unique_ptr<lw_gl, Destroy> gl_;
  std::unique_ptr<lw_gl_environment, Destroy> environment_;
  render::Program depth_program_, plane_program_;
  render::VertexArray vertices_, no_attributes_;
  render::Buffer buffer_;
  render::Texture target_;
  render::Framebuffer framebuffer_;
  int vertex_count_ = 0, side_ = 0;
};

}  // namespace lightwell::bench
