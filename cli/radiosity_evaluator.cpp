#include "cli/radiosity_evaluator.h"

#include <algorithm>

#include "precompute/core/random.h"
#include "precompute/transport/lightmap/near_lamp.h"

namespace lightwell::cli {
namespace {

constexpr uint64_t kSeed = 1;
constexpr uint32_t kNone = 0xffffffffu;
constexpr double kTolerance = 1e-7;
constexpr uint32_t kMostSweeps = 1000;
enum Dimension : uint32_t { kPiece = 0, kPlace = 1, kLight = 2 };
enum Side : uint32_t { kFront = 0, kBack = 1 };

/// Light of lamps at points of surfaces.
class LampLight {
 public:
  explicit LampLight(const RadiosityEvaluation& evaluation) : evaluation_(evaluation), lights_(evaluation.scene.scene.lights) {}

  /// Mean over the slot's surface on one side, of what is hidden too.
  Rgb meanOver(const atlas::Slot& slot, Side side, uint32_t points) {
    const Sampler sampler(kSeed, uint64_t(slot.texel) * 2 + side);
    const bake::ContainerScene& scene = evaluation_.scene;
    rays_.clear(), light_.clear(), near_.clear();
    const transport::NearLamp near_lamp = transport::nearLamp(scene.scene.mesh, scene.atlas, lights_, slot, side == kBack);
    Vec3d near_expected_rgb(0.0), near_arrived_rgb(0.0);
    for (uint32_t i = 0; i < points; ++i) {
      const auto point = atlas::sampleSlot(scene.scene.mesh, scene.atlas, slot, sampler.get1D(i, kPiece), sampler.get2D(i, kPlace));
      const Vec3 normal = side == kBack ? -point.normal : point.normal, facing = side == kBack ? -point.geometric_normal : point.geometric_normal;
      samples_.clear();
      if (near_lamp.light != kNone) {
        Vec3 to_light;
        float distance;
        near_expected_rgb += Vec3d(scene::lightIrradiance(lights_.lights()[near_lamp.light], point.position, facing, to_light, distance));
      }
      lights_.sample(point.position, normal, true, sampler.get1D(i, kLight), samples_);
      for (const auto& sample : samples_) {
        if (!(sample.to_light.dot(facing) > 0)) continue;
        rays_.push_back({.origin = trace::Tracer::offsetOrigin(point.position, facing, sample.to_light), .direction = sample.to_light,
                         .t_max = sample.distance * (1.0f - 1e-4f), .key = uint32_t(rays_.size())});
        light_.push_back(sample.irradiance_rgb);
        near_.push_back(sample.light == near_lamp.light);
      }
    }
    visibility_.resize(rays_.size());
    evaluation_.tracer.transmittance(rays_, visibility_);
    Vec3d sum(0.0);
    for (size_t i = 0; i < rays_.size(); ++i) (near_[i] ? near_arrived_rgb : sum) += Vec3d(light_[i]) * double(visibility_[i]);
    sum /= double(points);
    // Exact light times visible share, as light maps have it: points may all miss the spot that the lamp lights.
    for (int c = 0; c < 3; ++c)
      if (near_expected_rgb[c] > 0) sum[c] += near_lamp.irradiance_rgb[c] * (near_arrived_rgb[c] / near_expected_rgb[c]);
    return Rgb(sum);
  }

 private:
  const RadiosityEvaluation& evaluation_;
  transport::PunctualLights lights_;
  std::vector<transport::PunctualLights::Sample> samples_;
  std::vector<trace::Ray> rays_;
  std::vector<Rgb> light_;
  std::vector<uint8_t> near_;  // from the near lamp
  std::vector<float> visibility_;
};

}  // namespace

std::vector<float> tracedIrradiance(const RadiosityEvaluation& evaluation, const lw_radiosity* radiosity) {
  lw_radiosity_info info;
  lw_radiosity_patches patches;
  lw_radiosity_texels texels;
  evaluation.container.check(lw_radiosity_get_info(radiosity, &info));
  evaluation.container.check(lw_radiosity_get_patches(radiosity, &patches));
  evaluation.container.check(lw_radiosity_get_texels(radiosity, &texels));
  std::vector<float> irradiance_rgb(size_t(info.patches) * 3);
  const bake::ContainerScene& scene = evaluation.scene;
  if (scene.scene.lights.empty()) return irradiance_rgb;

  // A patch has many texels: an eighth of the points of each are enough.
  const uint32_t points = std::max(evaluation.samples / 8, 1u);
  struct Received {
    Rgb front{0.0f}, back{0.0f};
  };
  std::vector<Received> received(info.texels);
  const auto slotOf = [&](size_t i) { return texels.texel[i] < scene.atlas.texel_slot.size() ? scene.atlas.texel_slot[texels.texel[i]] : kNone; };
  parallelFor(info.texels, 64, evaluation.threads, evaluation.cancel, [&](size_t begin, size_t end) {
    LampLight light(evaluation);
    for (size_t i = begin; i < end; ++i) {
      const uint32_t slot = slotOf(i);
      if (slot == kNone) continue;
      received[i].front = light.meanOver(scene.atlas.slots[slot], kFront, points);
      if (texels.back_patch && texels.back_patch[i] != kNone) received[i].back = light.meanOver(scene.atlas.slots[slot], kBack, points);
    }
  });
  const double metres2 = double(scene.scene.metres_per_unit) * double(scene.scene.metres_per_unit);
  std::vector<double> power(irradiance_rgb.size());
  for (size_t i = 0; i < info.texels; ++i) {
    const uint32_t slot = slotOf(i);
    if (slot == kNone) continue;
    const double area_m2 = double(scene.atlas.slots[slot].area) * metres2;
    for (int k = 0; k < 3; ++k) {
      power[size_t(texels.patch[i * 4]) * 3 + size_t(k)] += area_m2 * double(received[i].front[k]);
      if (texels.back_patch && texels.back_patch[i] != kNone) power[size_t(texels.back_patch[i]) * 3 + size_t(k)] += area_m2 * double(received[i].back[k]);
    }
  }
  for (size_t i = 0; i < power.size(); ++i) irradiance_rgb[i] = float(power[i] / double(patches.area_m2[i / 3]));
  return irradiance_rgb;
}

std::vector<lw_light> lampsOf(const RadiosityEvaluation& evaluation) {
  std::vector<lw_light> lights;
  for (const scene::Light& light : evaluation.scene.scene.lights) lights.push_back(runtimeLight(evaluation.scene.scene, light));
  return lights;
}

namespace {

struct DestroyInjector {
  void operator()(lw_radiosity_injector* injector) const { lw_radiosity_injector_destroy(injector); }
};

std::vector<float> injectedIrradiance(const RadiosityEvaluation& evaluation, const lw_radiosity* radiosity, const lw_radiosity_state* state) {
  const RuntimeContainer& container = evaluation.container;
  lw_radiosity_info info;
  container.check(lw_radiosity_get_info(radiosity, &info));
  lw_radiosity_injector* made = nullptr;
  container.check(lw_radiosity_injector_create(container.get(), radiosity, *evaluation.injection, &made));
  const std::unique_ptr<lw_radiosity_injector, DestroyInjector> injector(made);
  container.check(lw_radiosity_injector_set_portals(injector.get(), state));
  const std::vector<lw_light> lights = lampsOf(evaluation);
  std::vector<float> irradiance_rgb(size_t(info.patches) * 3);
  container.check(lw_radiosity_inject(injector.get(), lights.data(), uint32_t(lights.size()), irradiance_rgb.data()));
  return irradiance_rgb;
}

}  // namespace

void setPortals(const RadiosityEvaluation& evaluation, lw_radiosity_state* state) {
  for (uint32_t i = 0; i < evaluation.portal_open.size(); ++i) evaluation.container.check(lw_radiosity_set_portal(state, i, evaluation.portal_open[i]));
}

ProbesHandle loadProbes(const RadiosityEvaluation& evaluation, const lw_radiosity* radiosity) {
  lw_probes* probes = nullptr;
  evaluation.container.check(lw_probes_load(evaluation.container.get(), radiosity, &probes));
  ProbesHandle handle(probes);
  lw_probes_info info;
  evaluation.container.check(lw_probes_get_info(probes, &info));
  evaluation.probes->position_m.assign(info.position_m, info.position_m + size_t(info.probes) * 3);
  evaluation.probes->radiance_sh.resize(size_t(info.probes) * 27);
  return handle;
}

std::vector<float> evaluateRadiosityOnCpu(const RadiosityEvaluation& evaluation) {
  const RuntimeContainer& container = evaluation.container;
  const auto radiosity = container.loadRadiosity();
  const auto state = container.createState(radiosity.get());
  setPortals(evaluation, state.get());
  const auto direct_rgb = evaluation.injection ? injectedIrradiance(evaluation, radiosity.get(), state.get()) : tracedIrradiance(evaluation, radiosity.get());
  container.check(lw_radiosity_set_direct(state.get(), direct_rgb.data()));
  container.check(lw_radiosity_solve(state.get(), kTolerance, kMostSweeps, nullptr));
  if (evaluation.probes) {
    const ProbesHandle probes = loadProbes(evaluation, radiosity.get());
    lw_probes_evaluation at_probes = LW_PROBES_EVALUATION_INIT;
    at_probes.light = evaluation.light;
    container.check(lw_probes_evaluate(probes.get(), state.get(), &at_probes, evaluation.probes->radiance_sh.data()));
  }
  lw_radiosity_info info;
  container.check(lw_radiosity_get_info(radiosity.get(), &info));
  lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
  shading.light = evaluation.light;
  shading.fill = 0;
  std::vector<float> atlas_rgba(size_t(info.width) * info.height * 4);
  container.check(lw_radiosity_shade(state.get(), &shading, atlas_rgba.data()));
  return atlas_rgba;
}

}  // namespace lightwell::cli
