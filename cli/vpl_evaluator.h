// What the virtual lights of a container make of the atlas, on the CPU.
#pragma once
#include <functional>
#include <optional>

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
  uint32_t samples;                // points of each texel are a sixteenth of it, at least four
  double cut_error = 0.1;         // what a group of lights may be wrong by, of the irradiance; 0: each light for itself
  std::optional<float> clamp = {};  // of a point's irradiance ÷ flux, 1/m²; 0: none; empty: as if it were as large as its share of all surfaces
  bool interpolate = true;         // texels between others where the light is smooth
  bool restore = true;             // what the clamp takes away
  int threads;
  const CancelFlag* cancel;
  std::function<void(double fraction)> progress;
};

struct VplEvaluated {
  std::vector<Rgb> irradiance_rgb;    // per slot
  uint64_t rays = 0;
  size_t texels = 0;                  // that were not interpolated
  double lights_a_point = 0;          // mean number of lights that a point looked at
  uint32_t lights = 0;                // all there are
  double removed = 0, restored = 0;   // by the clamp and after it, of what there is in the end
};

/// Mean over points of each texel of each light's exact irradiance, times how much of the light these points see; of lights that give little, one stands for others.
VplEvaluated evaluateVplOnCpu(const VplEvaluation& evaluation);

}  // namespace lightwell::cli
