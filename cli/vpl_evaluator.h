// What the virtual lights of a container make of the atlas, on the CPU.
#pragma once
#include <functional>

#include "cli/runtime_handles.h"
#include "precompute/bake/container_scene.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::cli {

struct VplEvaluation {
  const RuntimeContainer& container;
  const bake::ContainerScene& scene;
  const trace::Tracer& tracer;
  transport::Component component;  // direct: what emitters give; indirect: what has been reflected
  uint32_t samples;                // points of each texel, and of each light as seen from there
  int threads;
  const CancelFlag* cancel;
  std::function<void(double fraction)> progress;
};

/// Irradiance per slot: mean over points of the texel of each light's exact irradiance, times how much of the light these points see.
std::vector<Rgb> evaluateVplOnCpu(const VplEvaluation& evaluation);

}  // namespace lightwell::cli
