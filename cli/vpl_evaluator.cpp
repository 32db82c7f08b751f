#include "cli/vpl_evaluator.h"

#include <atomic>

#include "cli/vpl_texel_light.h"
#include "precompute/core/parallel.h"

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
  parallelFor(slots.size(), 16, evaluation.threads, evaluation.cancel, [&](size_t begin, size_t end) {
    TexelLight light(evaluation, set);
    for (size_t i = begin; i < end; ++i) results[i] = light.of(slots[i]);
    evaluation.progress(double(done += end - begin) / double(slots.size()));
  });
  VplEvaluated all;
  all.lights = info.lights;
  double total = 0, removed = 0, restored = 0;
  uint64_t looks = 0;
  for (size_t i = 0; i < slots.size(); ++i) {
    const double area = double(slots[i].area);
    all.irradiance_rgb.push_back(results[i].irradiance_rgb);
    total += area * double(luminance(results[i].irradiance_rgb));
    removed += area * results[i].removed, restored += area * results[i].restored;
    all.rays += results[i].rays, looks += results[i].lights;
  }
  if (total > 0) all.removed = removed / total, all.restored = restored / total;
  if (!slots.empty()) all.lights_a_point = double(looks) / double(slots.size() * pointsOf(evaluation));
  return all;
}

}  // namespace lightwell::cli
