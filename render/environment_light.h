// The sky of a container: background, and light with shadows on all surfaces.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lightwell/lightwell_gl.h"
#include "render/scene_mesh.h"

namespace lightwell::render {

/// How the light of a sky is computed; lightwell_gl.h explains the values.
struct EnvironmentSettings {
  uint32_t technique = LW_ENVIRONMENT_SHARE;  // LW_ENVIRONMENT_…
  uint32_t cells = 0;                         // cells in use, the suns and the brightest first; 0: all
  uint32_t map_texels = 256;                  // side of a cell's depth map
  uint32_t sun_map_texels = 1024;             // of a sun's
};

/// A point that a sky lights. `facing`: unit, the surface's true normal; `normal`: unit, the one it is shaded with.
struct EnvironmentPoint {
  Float3 position_m, facing, normal;  // relative to the container's origin
};

class EnvironmentLight {
 public:
  /// Uploads the section "environment". `gl` and `mesh` must outlive this. Throws RenderError.
  EnvironmentLight(const lw_container* container, lw_gl* gl, const SceneMesh& mesh, const EnvironmentSettings& settings);

  /// Draws depth maps that are not there yet. The scene does not move.
  void update();
  /// The radiance of the sky times `exposure` over the whole target. `right` and `up`: half the picture's sides at distance 1.
  void drawBackground(const Float3& forward, const Float3& right, const Float3& up, float exposure) const;
  /// Binds the sky for `surfaceProgram`, whose other uniforms are those of the renderer's programs.
  void bind() const;
  /// Irradiance at any points, computed as on the surfaces of a picture; waits for the GPU. Changes framebuffer, viewport, program.
  std::vector<Float3> irradianceAt(std::span<const EnvironmentPoint> points) const;
  const Program& surfaceProgram() const { return surface_program_; }

 private:
  struct Destroy {
    void operator()(lw_gl_environment* environment) const { lw_gl_environment_destroy(environment); }
  };
  void bindTo(const Program& program) const;
  void drawCasters(const float view_projection[16]) const;

  const SceneMesh& mesh_;
  EnvironmentSettings settings_;
  std::unique_ptr<lw_gl_environment, Destroy> environment_;
  Program depth_program_, surface_program_, background_program_, point_program_;
  VertexArray no_attributes_;
  bool has_maps_ = false;
};

}  // namespace lightwell::render
