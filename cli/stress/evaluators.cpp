#include "cli/stress/evaluators.h"

#include "cli/dynamic_evaluator.h"
#include "cli/environment_evaluator.h"
#include "cli/lightmap_evaluator.h"
#include "cli/prm_evaluator.h"
#include "cli/radiosity_evaluator.h"
#include "cli/slot_values.h"
#include "cli/vpl_evaluator.h"
#include "cli/vpl_evaluator_gl.h"
#include "render/egl_context.h"
#include "render/error.h"

namespace lightwell::stress {
namespace {

using plan::Technique;
using transport::Component;

constexpr uint32_t kSamples = 16;         // points of each texel at which evaluators look
constexpr uint32_t kShadowMapSide = 256;  // of a baked virtual light on OpenGL
constexpr float kPieces = 8;              // of lights that are large: as `lightwell evaluate` has them

bool hasDirect(const Job& job) { return job.component != Component::indirect; }
bool hasIndirect(const Job& job) { return job.component != Component::direct; }

cli::PrmEvaluation prmEvaluation(const Open& open) {
  cli::PrmEvaluation evaluation{.container = open.runtime, .scene = open.scene.scene, .tracer = open.tracer, .lights = {}};
  if (hasIndirect(open.job)) evaluation.lights = open.scene.scene.lights, evaluation.emitters |= LW_EMITTERS_INDIRECT | LW_SKY_INDIRECT;
  if (hasDirect(open.job)) evaluation.emitters |= LW_EMITTERS_DIRECT | LW_SKY_DIRECT;
  return evaluation;
}

cli::RadiosityEvaluation radiosityEvaluation(const Open& open) {
  const uint32_t light = (hasIndirect(open.job) ? LW_RADIOSITY_INDIRECT : 0) | (hasDirect(open.job) ? LW_RADIOSITY_EMITTERS : 0);
  return {.container = open.runtime, .scene = open.scene, .tracer = open.tracer, .light = light, .samples = kSamples, .portal_open = {}, .threads = open.threads, .cancel = &open.cancel};
}

uint32_t lightmapLight(const Job& job) { return (hasDirect(job) ? LW_LIGHTMAP_DIRECT : 0) | (hasIndirect(job) ? LW_LIGHTMAP_INDIRECT : 0); }

cli::EnvironmentEvaluation environmentEvaluation(const Open& open) {
  return {.container = open.runtime, .scene = open.scene, .tracer = open.tracer, .samples = kSamples, .threads = open.threads, .cancel = &open.cancel};
}

}  // namespace

std::vector<Rgb> evaluateOnCpu(const Open& open) {
  const atlas::Atlas& atlas = open.scene.atlas;
  switch (open.job.technique) {
    case Technique::prm: return cli::valuesOfSlots(atlas, cli::evaluatePrmOnCpu(prmEvaluation(open)));
    case Technique::radiosity: return cli::valuesOfSlots(atlas, cli::evaluateRadiosityOnCpu(radiosityEvaluation(open)));
    case Technique::lightmap: return cli::valuesOfSlots(atlas, cli::evaluateLightmapOnCpu(open.runtime, lightmapLight(open.job)));
    case Technique::vpl:
      return cli::evaluateVplOnCpu({.container = open.runtime, .scene = open.scene, .tracer = open.tracer, .component = open.job.component, .samples = kSamples,
                                    .threads = open.threads, .cancel = &open.cancel, .progress = [](double) {}})
          .irradiance_rgb;
    case Technique::environment: return cli::evaluateEnvironmentOnCpu(environmentEvaluation(open));
  }
  return {};
}

std::vector<Rgb> evaluateOnGl(const Open& open) {
  const atlas::Atlas& atlas = open.scene.atlas;
  switch (open.job.technique) {
    case Technique::prm: return cli::valuesOfSlots(atlas, cli::evaluatePrmOnGl(prmEvaluation(open)));
    case Technique::radiosity: return cli::valuesOfSlots(atlas, cli::evaluateRadiosityOnGl(radiosityEvaluation(open)));
    case Technique::lightmap: return cli::valuesOfSlots(atlas, cli::evaluateLightmapOnGl(open.runtime, lightmapLight(open.job)));
    case Technique::vpl:
      return cli::valuesOfSlots(atlas, cli::evaluateVplOnGl({.container = open.runtime, .component = open.job.component, .shadow_map_side = kShadowMapSide, .pieces = kPieces,
                                                             .progress = [&](double) { open.cancel.check(); }})
                                           .atlas_rgba);
    case Technique::environment: return cli::evaluateEnvironmentOnGl(environmentEvaluation(open));
  }
  return {};
}

std::vector<Rgb> evaluateDynamically(const Open& open, const Dynamic& dynamic) {
  return cli::valuesOfSlots(open.scene.atlas, cli::evaluateDynamicOnGl({.container = open.runtime, .scene = open.scene.scene, .incremental = dynamic.incremental,
                                                                        .lights = dynamic.lights, .shadow_side = dynamic.shadow_side}));
}

std::optional<std::string> reasonWithoutGl() {
  try {
    const render::EglContext context;
    return std::nullopt;
  } catch (const render::RenderError& error) {
    return error.what();
  }
}

}  // namespace lightwell::stress
