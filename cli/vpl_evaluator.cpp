#include "cli/vpl_evaluator.h"

#include <atomic>

#include "cli/vpl_texel_light.h"
#include "precompute/transport/texel_lattice.h"

namespace lightwell::cli {
namespace {

struct Release {
  void operator()(lw_virtual_lights* lights) const { lw_virtual_lights_release(lights); }
};

}  // namespace

VplEvaluated evaluateVplOnCpu(const VplEvaluation& evaluation) {
  lw_virtual_lights* raw = nullptr;
  evaluation.container.check(lw_virtual_lights_load(evaluation.container.get(), &raw));
  const std::unique_ptr<lw_virtual_lights, Release> handle(raw);
  lw_virtual_lights_info info;
  evaluation.container.check(lw_virtual_lights_get_info(raw, &info));
  std::vector<lw_virtual_light> lights(info.lights);
  for (uint32_t i = 0; i < info.lights; ++i) evaluation.container.check(lw_virtual_lights_get(raw, i, &lights[i]));
  const VirtualLightSet set(evaluation, std::move(lights));
  const auto& slots = evaluation.scene.atlas.slots;
  std::vector<TexelLightResult> results(slots.size());
  std::atomic<size_t> done = 0;
  VplEvaluated all;
  all.irradiance_rgb = transport::valuesOverLattice(
      evaluation.scene.atlas, evaluation.tracer, {.coarsest = evaluation.interpolate ? 8u : 1u}, evaluation.threads, evaluation.cancel,
      [&](std::span<const uint32_t> some, std::span<Rgb> values_rgb) {
        TexelLight light(evaluation, set);
        for (size_t i = 0; i < some.size(); ++i) {
          results[some[i]] = light.of(slots[some[i]]);
          values_rgb[i] = results[some[i]].irradiance_rgb;
        }
        evaluation.progress(double(done += some.size()) / double(slots.size()));
      },
      &all.texels);
  all.lights = info.lights;
  double total = 0, removed = 0, restored = 0;
  uint64_t looks = 0;
  for (size_t i = 0; i < slots.size(); ++i) {
    const double area = double(slots[i].area);
    total += area * double(luminance(results[i].irradiance_rgb));
    removed += area * results[i].removed, restored += area * results[i].restored;
    all.rays += results[i].rays, looks += results[i].lights;
  }
  if (total > 0) all.removed = removed / total, all.restored = restored / total;
  if (all.texels > 0) all.lights_a_point = double(looks) / double(all.texels * pointsOf(evaluation));
  return all;
}

}  // namespace lightwell::cli
