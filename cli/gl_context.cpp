#include "cli/gl_context.h"

#include "precompute/core/error.h"
#include "render/error.h"

namespace lightwell::cli {

GlContext::GlContext(const RuntimeContainer& container) {
  try {
    context_ = std::make_unique<render::EglContext>();
  } catch (const render::RenderError& error) {
    throw UsageError(std::string("--evaluator gl: ") + error.what());
  }
  lw_gl_config config = LW_GL_CONFIG_INIT;
  config.loader = render::EglContext::load;
  lw_gl* gl = nullptr;
  container.check(lw_gl_create(&config, &gl));
  gl_.reset(gl);
}

}  // namespace lightwell::cli
