// Evaluating the section "prm" with the runtime: on the CPU, or on OpenGL without a window. Visibility is ray-traced in both.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "cli/probe_light.h"
#include "cli/runtime_handles.h"
#include "precompute/trace/tracer.h"

namespace lightwell::cli {

struct PrmEvaluation {
  const RuntimeContainer& container;
  const scene::Scene& scene;       // of the container (bake::loadContainerScene)
  const trace::Tracer& tracer;     // of that scene
  std::span<const scene::Light> lights;
  uint32_t emitters = LW_EMITTERS_OFF;  // LW_EMITTERS_… and LW_SKY_… bits to add
  std::optional<uint32_t> brightest;    // panes to sum, 0: all; unset: what the bake recommends
};

/// Irradiance, [height * width][4]: each texel's own mean, not what it shows in a game; A = 1 where the transport has a value.
std::vector<float> evaluatePrmOnCpu(const PrmEvaluation& evaluation);
/// The same on an OpenGL 3.3 context without a surface. Throws UsageError when this machine gives none.
std::vector<float> evaluatePrmOnGl(const PrmEvaluation& evaluation);

/// A loaded transport evaluated on the CPU, for many lights one after the other.
class CpuPrm {
 public:
  explicit CpuPrm(const RuntimeContainer& container);
  const lw_prm_info& info() const { return info_; }
  /// [clusters][3]: direct irradiance of `lights`, shadowed by `tracer`, the tracer of `scene`.
  std::vector<float> clusterIrradiance(const scene::Scene& scene, const trace::Tracer& tracer, std::span<const scene::Light> lights) const;
  /// [height * width][4], as lw_prm_evaluate.
  std::vector<float> evaluate(std::span<const float> cluster_irradiance_rgb, const lw_prm_options& options) const;
  /// What the probes of the section "prm_probes" receive, with the light of emitters or without.
  ProbeLight evaluateProbes(std::span<const float> cluster_irradiance_rgb, bool emitters) const;

 private:
  const RuntimeContainer& container_;
  std::unique_ptr<lw_prm, ReleasePrm> prm_;
  lw_prm_info info_;
};

/// For every entry point of `prm`, how much of `light` arrives (1 where it could not reach anyway).
std::vector<float> entryVisibility(const PrmEvaluation& evaluation, const lw_prm* prm, const lw_light& light);

/// An lw_visibility_fn whose `user` is a VisibilityTracer.
struct VisibilityTracer {
  const scene::Scene& scene;
  const trace::Tracer& tracer;
  float* by_entry = nullptr;  // if set, receives the answers at their entry points
};
void traceVisibility(void* visibility_tracer, const lw_shadow_ray* rays, uint32_t count, float* visibility);

}  // namespace lightwell::cli
