#include "cli/dynamic_evaluator.h"

#include "lightwell/lightwell_gl_dynamic.h"
#include "precompute/core/error.h"
#include "render/egl_context.h"
#include "render/error.h"

namespace lightwell::cli {
namespace {

struct Destroy {
  void operator()(lw_gl_dynamic* scene) const { lw_gl_dynamic_destroy(scene); }
  void operator()(lw_gl_lamp* lamp) const { lw_gl_lamp_destroy(lamp); }
};

std::unique_ptr<render::EglContext> makeContext() {
  try {
    return std::make_unique<render::EglContext>();
  } catch (const render::RenderError& error) {
    throw UsageError(std::string("--evaluator gl: ") + error.what());
  }
}

}  // namespace

std::vector<float> evaluateDynamicOnGl(const DynamicEvaluation& e) {
  const auto context = makeContext();
  std::string message;
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.message = [](void* user, lw_result, const char* text) { *static_cast<std::string*>(user) = text; };
  config.message_user = &message;
  config.loader = render::EglContext::load;
  lw_gl_dynamic_options options = LW_GL_DYNAMIC_OPTIONS_INIT;
  options.atlas_format = LW_GL_ATLAS_RGBA32F;
  options.fill = 0;
  const auto check = [&](lw_result result) {
    if (!message.empty() && result) throw std::runtime_error(message);
    e.container.check(result);
  };
  lw_gl_dynamic* raw_scene = nullptr;
  check(lw_gl_dynamic_create(&config, e.container.get(), &options, &raw_scene));
  const std::unique_ptr<lw_gl_dynamic, Destroy> scene(raw_scene);
  lw_gl_lamp_options lamp_options = LW_GL_LAMP_OPTIONS_INIT;
  lamp_options.lights = e.lights;
  lamp_options.shadow_side = e.shadow_side;
  lamp_options.incremental = e.incremental;
  lamp_options.most_updates = e.lights;
  std::vector<std::unique_ptr<lw_gl_lamp, Destroy>> lamps;
  std::vector<lw_gl_lamp*> shining;
  for (const scene::Light& light : e.scene.lights) {
    lw_gl_lamp* lamp = nullptr;
    check(lw_gl_lamp_create(scene.get(), &lamp_options, &lamp));
    lamps.emplace_back(lamp);
    shining.push_back(lamp);
    const lw_light given = runtimeLight(e.scene, light);
    // Incremental lights are spread first and then go where there is room.
    for (int i = 0; i < (e.incremental ? 4 : 1); ++i) check(lw_gl_lamp_update(lamp, &given, nullptr));
  }
  check(lw_gl_dynamic_gather(scene.get(), shining.data(), uint32_t(shining.size()), nullptr));
  lw_atlas_info atlas;
  check(lw_get_atlas_info(e.container.get(), &atlas));
  std::vector<float> atlas_rgba(size_t(atlas.width) * atlas.height * 4);
  check(lw_gl_dynamic_read_atlas(scene.get(), atlas_rgba.data()));
  return atlas_rgba;
}

}  // namespace lightwell::cli
