// Evaluating the section "radiosity" with the runtime: on the CPU, or on OpenGL without a window.
#pragma once
#include <optional>
#include <vector>

#include "cli/probe_light.h"
#include "cli/runtime_handles.h"
#include "precompute/bake/container_scene.h"
#include "precompute/core/parallel.h"
#include "precompute/trace/tracer.h"

namespace lightwell::cli {

struct RadiosityEvaluation {
  const RuntimeContainer& container;
  const bake::ContainerScene& scene;   // of the container; its lights shine
  const trace::Tracer& tracer;         // of that scene
  uint32_t light = LW_RADIOSITY_INDIRECT;  // LW_RADIOSITY_… bits to add
  uint32_t samples = 64;               // points of each texel at which light of lamps is sampled
  std::vector<float> portal_open;      // per portal of the scene, 0 to 1, as the tracer has them
  std::optional<uint32_t> injection;   // texels along a face of the lights' views; unset: rays
  ProbeLight* probes = nullptr;        // set: receives the same light at the container's probes
  int threads = 0;
  const CancelFlag* cancel = nullptr;
};

/// Irradiance, [height * width][4], all bounces: each texel's own mean, not what it shows in a game; A = 1 where there is a value.
std::vector<float> evaluateRadiosityOnCpu(const RadiosityEvaluation& evaluation);
/// The same on an OpenGL 3.3 context without a surface. Throws UsageError when this machine gives none.
std::vector<float> evaluateRadiosityOnGl(const RadiosityEvaluation& evaluation);

/// Direct irradiance of the scene's lights on the patches, [patches][3], from rays: the power that falls on a patch over its exposed area.
std::vector<float> tracedIrradiance(const RadiosityEvaluation& evaluation, const lw_radiosity* radiosity);
std::vector<lw_light> lampsOf(const RadiosityEvaluation& evaluation);
struct ReleaseProbes {
  void operator()(lw_probes* probes) const { lw_probes_release(probes); }
};
using ProbesHandle = std::unique_ptr<lw_probes, ReleaseProbes>;
/// Loads the container's probes and fills what `evaluation.probes` can know of them without light.
ProbesHandle loadProbes(const RadiosityEvaluation& evaluation, const lw_radiosity* radiosity);
void setPortals(const RadiosityEvaluation& evaluation, lw_radiosity_state* state);

}  // namespace lightwell::cli
