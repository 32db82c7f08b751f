#include "cli/prm_evaluator.h"

#include <lightwell/lightwell_prm_probes.h>

#include <array>
#include <cmath>

namespace lightwell::cli {

void traceVisibility(void* visibility_tracer, const lw_shadow_ray* rays, uint32_t count, float* visibility) {
  const auto& self = *static_cast<const VisibilityTracer*>(visibility_tracer);
  constexpr float kShortOfLight = 1.0f - 1e-4f;  // a lamp's own body, modelled around its light, does not hide it
  const float units_per_metre = float(1.0 / self.scene.metres_per_unit);
  std::vector<trace::Ray> segments(count);
  for (uint32_t i = 0; i < count; ++i) {
    const lw_shadow_ray& ray = rays[i];
    const Vec3 position = Vec3(ray.origin_m[0], ray.origin_m[1], ray.origin_m[2]) * units_per_metre;
    const Vec3 normal(ray.normal[0], ray.normal[1], ray.normal[2]), direction(ray.direction[0], ray.direction[1], ray.direction[2]);
    segments[i] = {.origin = trace::Tracer::offsetOrigin(position, normal, direction),
                   .direction = direction,
                   .t_max = ray.distance_m * units_per_metre * kShortOfLight,
                   .key = ray.entry};
  }
  self.tracer.transmittance(segments, std::span(visibility, count));
  if (self.by_entry)
    for (uint32_t i = 0; i < count; ++i) self.by_entry[rays[i].entry] = visibility[i];
}

std::vector<float> entryVisibility(const PrmEvaluation& evaluation, const lw_prm* prm, const lw_light& light) {
  lw_prm_info info;
  evaluation.container.check(lw_prm_get_info(prm, &info));
  std::vector<float> visibility(info.entries, 1.0f), unused(size_t(info.entries) * 3);
  VisibilityTracer tracer{evaluation.scene, evaluation.tracer, visibility.data()};
  evaluation.container.check(lw_prm_entry_irradiance(prm, &light, 1, traceVisibility, &tracer, unused.data()));
  return visibility;
}

CpuPrm::CpuPrm(const RuntimeContainer& container) : container_(container), prm_(container.loadPrm()) {
  container.check(lw_prm_get_info(prm_.get(), &info_));
}

std::vector<float> CpuPrm::clusterIrradiance(const scene::Scene& scene, const trace::Tracer& tracer,
                                             std::span<const scene::Light> lights) const {
  std::vector<lw_light> runtime_lights;
  for (const auto& light : lights) runtime_lights.push_back(runtimeLight(scene, light));
  std::vector<float> entry_rgb(size_t(info_.entries) * 3), cluster_rgb(size_t(info_.clusters) * 3);
  VisibilityTracer visibility{scene, tracer};
  container_.check(lw_prm_entry_irradiance(prm_.get(), runtime_lights.data(), uint32_t(lights.size()), traceVisibility, &visibility,
                                           entry_rgb.data()));
  container_.check(lw_prm_cluster_irradiance(prm_.get(), entry_rgb.data(), cluster_rgb.data()));
  return cluster_rgb;
}

std::vector<float> CpuPrm::evaluate(std::span<const float> cluster_irradiance_rgb, const lw_prm_options& options) const {
  std::vector<float> scratch((lw_prm_scratch_bytes(prm_.get()) + sizeof(float) - 1) / sizeof(float));
  std::vector<float> atlas_rgba(size_t(info_.width) * info_.height * 4);
  container_.check(lw_prm_evaluate(prm_.get(), cluster_irradiance_rgb.data(), &options, scratch.data(), scratch.size() * sizeof(float),
                                   atlas_rgba.data()));
  return atlas_rgba;
}

ProbeLight CpuPrm::evaluateProbes(std::span<const float> cluster_irradiance_rgb, bool emitters) const {
  lw_prm_probes* loaded = nullptr;
  container_.check(lw_prm_probes_load(container_.get(), prm_.get(), &loaded));
  const std::unique_ptr<lw_prm_probes, decltype([](lw_prm_probes* p) { lw_prm_probes_release(p); })> probes(loaded);
  lw_prm_probes_info info;
  container_.check(lw_prm_probes_get_info(loaded, &info));
  ProbeLight light;
  light.position_m.assign(info.position_m, info.position_m + size_t(info.probes) * 3);
  light.radiance_sh.resize(size_t(info.probes) * 27);
  lw_prm_probes_evaluation evaluation = LW_PRM_PROBES_EVALUATION_INIT;
  evaluation.emitters = emitters;
  std::vector<float> scratch(lw_prm_probes_scratch_bytes(loaded) / sizeof(float));
  container_.check(lw_prm_probes_evaluate(loaded, cluster_irradiance_rgb.data(), &evaluation, scratch.data(), scratch.size() * sizeof(float), light.radiance_sh.data()));
  return light;
}

std::vector<float> evaluatePrmOnCpu(const PrmEvaluation& evaluation) {
  const CpuPrm prm(evaluation.container);
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  options.brightest = evaluation.brightest.value_or(prm.info().brightest);
  options.emitters = evaluation.emitters;
  options.fill = 0;
  return prm.evaluate(prm.clusterIrradiance(evaluation.scene, evaluation.tracer, evaluation.lights), options);
}

}  // namespace lightwell::cli
