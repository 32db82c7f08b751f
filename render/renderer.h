// Draws a container: live direct light with shadow maps, a sky with its own, indirect light from the runtime's atlas, emitting surfaces.
//
//   render::EglContext context;                                    // or a window's
//   render::Renderer renderer(container, render::EglContext::load, nullptr);
//   renderer.setLights(lights);                                    // the scene's own shine until then
//   render::Image8 image = renderer.render(render::readCamera("cam.json"));
//
// Works on OpenGL 3.3 core and OpenGL ES 3.0 with EXT_color_buffer_float. All calls on the thread of the context that was current at
// construction. OpenGL state is left changed; the game loop that draws on needs to set its own.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "lightwell/lightwell_gl.h"
#include "render/environment_light.h"
#include "render/indirect_light.h"
#include "render/png.h"
#include "render/view.h"

namespace lightwell::render {

/// Wall time of the parts of a frame, milliseconds; each waits for the GPU, so only measured on request.
struct FrameTimes {
  double shadows_ms = 0;    // depth maps of the lights that moved
  double environment_ms = 0;  // depth maps of the sky
  double transport_ms = 0;  // lw_gl_update_entries and lw_gl_evaluate
  double shading_ms = 0;    // the picture
};

struct RendererOptions {
  EnvironmentSettings environment;
  Technique technique = Technique::automatic;  // of the indirect light
  std::vector<PortalState> portals;            // doors that stand open; those not named are shut
};

class Renderer {
 public:
  /// Decodes and uploads; `container` is not used afterwards. `loader` as in lw_gl_config. A container without precomputed light shows
  /// direct light only; one with an environment shows its sky and is lit by it. Throws RenderError.
  Renderer(const lw_container* container, lw_gl_proc (*loader)(void*, const char*), void* loader_user, const RendererOptions& options = {});
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  /// Replaces the punctual lights; positions relative to the container's origin. Takes effect with the next picture.
  void setLights(std::span<const lw_light> lights);
  const std::vector<lw_light>& lights() const;
  const lw_scene_info& sceneInfo() const;
  bool hasTransport() const;
  bool hasEnvironment() const;

  /// Draws into `framebuffer` (0: the window's) of at least view.width × view.height pixels, sRGB-encoded. With an empty
  /// exposure_ev, meters first.
  void draw(const View& view, uint32_t framebuffer);
  /// The same into an image, row 0 at the top.
  Image8 render(const View& view);
  /// The exposure value that brings the geometric mean of the picture's radiance to middle grey (ISO 100, meter constant 12.5); 0 for a
  /// black picture. Draws a small picture and waits for it.
  float meterExposure(const View& view);

  void measureTimes(bool on);
  const FrameTimes& times() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell::render
