#include "cli/gl_context.h"
#include "cli/prm_evaluator.h"

namespace lightwell::cli {
namespace {

/// The visibility textures of the lights; they end with the transport that made them.
class VisibilityTextures {
 public:
  VisibilityTextures(const RuntimeContainer& container, lw_gl_prm* prm) : container_(container), prm_(prm) {}
  ~VisibilityTextures() {
    for (const uint32_t texture : textures_) lw_gl_destroy_visibility(prm_, texture);
  }
  uint32_t add(const std::vector<float>& visibility) {
    uint32_t texture = 0;
    container_.check(lw_gl_create_visibility(prm_, &texture));
    textures_.push_back(texture);
    container_.check(lw_gl_upload_visibility(prm_, texture, visibility.data()));
    return texture;
  }

 private:
  const RuntimeContainer& container_;
  lw_gl_prm* prm_;
  std::vector<uint32_t> textures_;
};

}  // namespace

std::vector<float> evaluatePrmOnGl(const PrmEvaluation& evaluation) {
  const RuntimeContainer& container = evaluation.container;
  const auto prm = container.loadPrm();
  lw_prm_info info;
  container.check(lw_prm_get_info(prm.get(), &info));

  const GlContext gl(container);
  lw_gl_prm_options prm_options = LW_GL_PRM_OPTIONS_INIT;
  prm_options.atlas_format = LW_GL_ATLAS_RGBA32F;  // an EXR holds 32-bit floats; a game is served by the half of it
  prm_options.reconstruct = LW_GL_RECONSTRUCT_SHADER;  // the CPU has a backend of its own
  lw_gl_prm* gl_prm_raw = nullptr;
  container.check(lw_gl_prm_create(gl.get(), prm.get(), &prm_options, &gl_prm_raw));
  const GlPrmHandle gl_prm(gl_prm_raw);

  VisibilityTextures textures(container, gl_prm.get());
  std::vector<lw_gl_light> lights;
  for (const auto& light : evaluation.lights) {
    lw_gl_light gl_light = LW_GL_LIGHT_INIT;
    gl_light.light = runtimeLight(evaluation.scene, light);
    gl_light.shadow = LW_GL_SHADOW_VISIBILITY;
    gl_light.shadow_texture = textures.add(entryVisibility(evaluation, prm.get(), gl_light.light));
    lights.push_back(gl_light);
  }
  container.check(lw_gl_update_entries(gl_prm.get(), lights.data(), uint32_t(lights.size())));
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  options.brightest = evaluation.brightest.value_or(info.brightest);
  options.emitters = evaluation.emitters;
  options.fill = 0;
  container.check(lw_gl_evaluate(gl_prm.get(), &options));
  std::vector<float> atlas_rgba(size_t(info.width) * info.height * 4);
  container.check(lw_gl_read_atlas(gl_prm.get(), atlas_rgba.data()));
  return atlas_rgba;
}

}  // namespace lightwell::cli
