#include "cli/vpl_evaluator_gl.h"

#include <chrono>

#include "cli/gl_context.h"
#include "lightwell/lightwell_gl_vpl.h"

namespace lightwell::cli {
namespace {

constexpr double kStep_ms = 100;  // between reports

struct Release {
  void operator()(lw_virtual_lights* lights) const { lw_virtual_lights_release(lights); }
  void operator()(lw_gl_vpl* vpl) const { lw_gl_vpl_destroy(vpl); }
};

double msSince(std::chrono::steady_clock::time_point begin) { return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count(); }

}  // namespace

VplGlResult evaluateVplOnGl(const VplGlEvaluation& evaluation) {
  const RuntimeContainer& container = evaluation.container;
  lw_virtual_lights* lights_raw = nullptr;
  container.check(lw_virtual_lights_load(container.get(), &lights_raw));
  const std::unique_ptr<lw_virtual_lights, Release> lights(lights_raw);
  const GlContext gl(container);
  lw_gl_vpl_options options = LW_GL_VPL_OPTIONS_INIT;
  options.atlas_format = LW_GL_ATLAS_RGBA32F;
  options.fill = 0;
  if (evaluation.component == transport::Component::direct) options.component = LW_GL_VPL_DIRECT;
  if (evaluation.component == transport::Component::indirect) options.component = LW_GL_VPL_INDIRECT;
  options.shadow_map_side = evaluation.shadow_map_side;
  options.pieces = evaluation.pieces;
  const auto begin = std::chrono::steady_clock::now();
  lw_gl_vpl* vpl_raw = nullptr;
  container.check(lw_gl_vpl_create(gl.get(), container.get(), lights.get(), &options, &vpl_raw));
  const std::unique_ptr<lw_gl_vpl, Release> vpl(vpl_raw);
  VplGlResult result{.lights = 0, .setup_ms = msSince(begin), .draw_ms = 0};
  for (lw_gl_vpl_progress step{0, 1, 0}; step.lights_left > 0;) {
    container.check(lw_gl_vpl_step(vpl.get(), kStep_ms, &step));
    result.lights += step.lights_drawn;
    result.draw_ms += step.ms;
    evaluation.progress(double(result.lights) / double(std::max(result.lights + step.lights_left, 1u)));
  }
  lw_array_info info;
  container.check(lw_get_array_info(container.get(), LW_ARRAY_ATLAS_SOURCE, &info));
  result.atlas_rgba.resize(size_t(info.elements) * 4);
  container.check(lw_gl_vpl_read(vpl.get(), result.atlas_rgba.data()));
  return result;
}

}  // namespace lightwell::cli
