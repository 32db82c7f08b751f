// Evaluating the section "environment" on the surfaces of a scene: the shadowed light of a sky's cells, straight, one value a texel.
#pragma once
#include <functional>
#include <vector>

#include "cli/runtime_handles.h"
#include "precompute/bake/container_scene.h"
#include "precompute/trace/tracer.h"
#include "render/environment_light.h"

namespace lightwell::cli {

struct EnvironmentEvaluation {
  const RuntimeContainer& container;
  const bake::ContainerScene& scene;  // of the container
  const trace::Tracer& tracer;        // of that scene
  uint32_t samples = 64;              // points of each texel, > 0
  render::EnvironmentSettings settings;  // only for OpenGL
  int threads = 0;
  const CancelFlag* cancel = nullptr;
  std::function<void(double fraction)> progress;  // may be empty; called from any thread
};

/// Irradiance per slot: lw_environment_irradiance, a ray to the centre of each cell for its visibility.
std::vector<Rgb> evaluateEnvironmentOnCpu(const EnvironmentEvaluation& evaluation);
/// The same as `render` shades its surfaces: in a fragment shader, with depth maps. Throws UsageError when this machine cannot.
std::vector<Rgb> evaluateEnvironmentOnGl(const EnvironmentEvaluation& evaluation);

}  // namespace lightwell::cli
