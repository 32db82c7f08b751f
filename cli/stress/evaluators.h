// Every evaluator that `lightwell evaluate` has, as the stress table asks them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "cli/runtime_handles.h"
#include "cli/stress/workbench.h"
#include "precompute/trace/tracer.h"

namespace lightwell::stress {

/// A baked job, open.
struct Open {
  const Job& job;
  const cli::RuntimeContainer& runtime;
  const bake::ContainerScene& scene;  // of the container
  const trace::Tracer& tracer;        // of that scene
  int threads;
  const CancelFlag& cancel;
};

/// Irradiance per slot. Throws what the runtime throws.
std::vector<Rgb> evaluateOnCpu(const Open& open);
std::vector<Rgb> evaluateOnGl(const Open& open);
/// One reflection of the scene's lamps, found anew on OpenGL (lightwell_dynamic).
std::vector<Rgb> evaluateDynamically(const Open& open, const Dynamic& dynamic);

/// Why this machine has no OpenGL context; nothing when it has one.
std::optional<std::string> reasonWithoutGl();

}  // namespace lightwell::stress
