#include "cli/gl_context.h"
#include "cli/radiosity_evaluator.h"

namespace lightwell::cli {
namespace {

constexpr double kTolerance = 1e-5;
constexpr uint32_t kMostSweeps = 1000;

}  // namespace

std::vector<float> evaluateRadiosityOnGl(const RadiosityEvaluation& evaluation) {
  const RuntimeContainer& container = evaluation.container;
  const auto radiosity = container.loadRadiosity();
  const auto state = container.createState(radiosity.get());
  lw_radiosity_info info;
  container.check(lw_radiosity_get_info(radiosity.get(), &info));

  const GlContext gl(container);
  lw_gl_radiosity_options options = LW_GL_RADIOSITY_OPTIONS_INIT;
  options.atlas_format = LW_GL_ATLAS_RGBA32F;  // an EXR holds 32-bit floats; a game is served by the half of it
  lw_gl_radiosity* gl_radiosity_raw = nullptr;
  container.check(lw_gl_radiosity_create(gl.get(), radiosity.get(), &options, &gl_radiosity_raw));
  const GlRadiosityHandle gl_radiosity(gl_radiosity_raw);
  setPortals(evaluation, state.get());
  container.check(lw_gl_radiosity_upload(gl_radiosity.get(), state.get(), LW_GL_RADIOSITY_PORTALS));
  if (evaluation.injection) {
    lw_gl_radiosity_injector* injector_raw = nullptr;
    container.check(lw_gl_radiosity_injector_create(gl_radiosity.get(), container.get(), radiosity.get(), *evaluation.injection, &injector_raw));
    const GlRadiosityInjectorHandle injector(injector_raw);
    const std::vector<lw_light> lights = lampsOf(evaluation);
    container.check(lw_gl_radiosity_inject(injector.get(), lights.data(), uint32_t(lights.size())));
  } else {
    container.check(lw_radiosity_set_direct(state.get(), tracedIrradiance(evaluation, radiosity.get()).data()));
    container.check(lw_gl_radiosity_upload(gl_radiosity.get(), state.get(), LW_GL_RADIOSITY_DIRECT));
  }
  container.check(lw_gl_radiosity_solve(gl_radiosity.get(), kTolerance, kMostSweeps, nullptr));
  if (evaluation.probes) {
    const ProbesHandle probes = loadProbes(evaluation, radiosity.get());
    lw_gl_probes* gl_probes_raw = nullptr;
    container.check(lw_gl_probes_create(gl_radiosity.get(), probes.get(), nullptr, &gl_probes_raw));
    const GlProbesHandle gl_probes(gl_probes_raw);
    container.check(lw_gl_probes_evaluate(gl_probes.get(), evaluation.light));
    container.check(lw_gl_probes_read(gl_probes.get(), evaluation.probes->radiance_sh.data()));
  }
  lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
  shading.light = evaluation.light;
  shading.fill = 0;
  container.check(lw_gl_radiosity_shade(gl_radiosity.get(), &shading));
  std::vector<float> atlas_rgba(size_t(info.width) * info.height * 4);
  container.check(lw_gl_radiosity_read_atlas(gl_radiosity.get(), atlas_rgba.data()));
  return atlas_rgba;
}

}  // namespace lightwell::cli
