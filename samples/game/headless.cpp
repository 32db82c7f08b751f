// The scripted run without a window: how the game is tested.
#include <cstdio>

#include "render/camera_json.h"
#include "render/egl_context.h"
#include "render/lights_json.h"
#include "render/renderer.h"
#include "samples/game/lamps.h"
#include "samples/game/options.h"
#include "samples/game/player.h"

namespace lightwell::game {

int runHeadless(const Options& options, lw_container* container) {
  const auto context = options.es ? std::make_unique<render::EglContext>(render::GlApi::es) : std::make_unique<render::EglContext>();
  render::Renderer renderer(container, render::EglContext::load, nullptr);
  const lw_scene_info& scene = renderer.sceneInfo();
  render::View view;
  if (options.camera) view = render::readCamera(*options.camera);
  else Player(scene).applyTo(view);
  view.width = options.width;
  view.height = options.height;
  view.show_lamps = true;
  if (options.part) view.part = *options.part;
  Lamps lamps(options.lights ? render::readLights(*options.lights, scene.origin_m) : renderer.lights(), scene);

  std::printf("%s\n", context->description().c_str());
  // One exposure for the whole run, so that the pictures compare.
  lamps.followPath(0);
  renderer.setLights(lamps.lit());
  if (!view.exposure_ev) view.exposure_ev = renderer.meterExposure(view);
  renderer.measureTimes(true);
  render::FrameTimes sum;
  const int frames = options.frames > 0 ? options.frames : 1;
  for (int frame = 0; frame < frames; ++frame) {
    lamps.followPath(float(frame) / float(frames));
    renderer.setLights(lamps.lit());
    char name[32];
    std::snprintf(name, sizeof name, "_%03d.png", frame);
    render::writePng(options.output_prefix + name, renderer.render(view));
    sum.shadows_ms += renderer.times().shadows_ms;
    sum.transport_ms += renderer.times().transport_ms;
    sum.shading_ms += renderer.times().shading_ms;
  }
  std::printf("%d frames of %d x %d, %s light, EV %.2f; per frame: shadow maps %.1f ms, transport %.1f ms, shading %.1f ms\n", frames,
              view.width, view.height, render::partName(view.part), double(*view.exposure_ev), sum.shadows_ms / frames,
              sum.transport_ms / frames, sum.shading_ms / frames);
  return 0;
}

}  // namespace lightwell::game
