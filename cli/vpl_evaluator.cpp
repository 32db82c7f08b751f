#include "cli/vpl_evaluator.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "precompute/core/parallel.h"
#include "precompute/core/random.h"

namespace lightwell::cli {
namespace {

constexpr uint64_t kSeed = 1;
constexpr uint32_t kLeastPoints = 4;
enum Dimension : uint32_t { kPiece = 0, kPlace = 1, kOnLight = 2 };

struct Release {
  void operator()(lw_virtual_lights* lights) const { lw_virtual_lights_release(lights); }
};

/// One texel after the other; keeps its arrays.
class TexelLight {
 public:
  TexelLight(const VplEvaluation& evaluation, const std::vector<lw_virtual_light>& lights, uint32_t points)
      : evaluation_(evaluation), lights_(lights), points_(points), metres_(float(evaluation.scene.scene.metres_per_unit)) {}

  Rgb of(const atlas::Slot& slot) {
    const Sampler sampler(kSeed, slot.texel);
    std::vector<atlas::SurfacePoint> at;
    for (uint32_t i = 0; i < points_; ++i)
      at.push_back(atlas::sampleSlot(evaluation_.scene.scene.mesh, evaluation_.scene.atlas, slot, sampler.get1D(i, kPiece),
                                     sampler.get2D(i, kPlace)));
    Vec3d sum(0.0);
    for (uint32_t light = 0; light < lights_.size(); ++light) sum += lightOf(light, at, sampler);
    return Rgb(sum);
  }

 private:
  /// Exact irradiance times visible share, the latter as a ratio of two sums over the same rays (Heitz et al., "Combining Analytic Direct
  /// Illumination and Stochastic Shadows", I3D 2018).
  Vec3d lightOf(uint32_t index, const std::vector<atlas::SurfacePoint>& at, const Sampler& sampler) {
    const lw_virtual_light& light = lights_[index];
    const Vec3 light_normal(light.normal[0], light.normal[1], light.normal[2]);
    rays_.clear(), weight_.clear();
    Vec3d exact(0.0);
    double expected = 0;
    for (uint32_t i = 0; i < points_; ++i) {
      const Vec3 position_m = at[i].position * metres_;
      float rgb[3];
      evaluation_.container.check(lw_virtual_light_irradiance(&light, &position_m.x, &at[i].normal.x, 0.0f, rgb));
      const Vec3d irradiance_rgb(rgb[0], rgb[1], rgb[2]);
      if (!(irradiance_rgb.x + irradiance_rgb.y + irradiance_rgb.z > 0)) continue;
      exact += irradiance_rgb;
      const Vec2 uv = sampler.get2D(i, kOnLight + index);
      Vec3 target_m;
      evaluation_.container.check(lw_virtual_light_point(&light, &uv.x, &target_m.x));
      const Vec3 target = target_m / metres_, offset = target - at[i].position;
      const float distance2 = offset.length2();
      if (!(distance2 > 0)) continue;
      const Vec3 direction = offset / std::sqrt(distance2);
      // A sphere's points count by distance alone: its light comes from all around it.
      const float sent = light.type == LW_VIRTUAL_SPHERE ? 1.0f : std::max(-direction.dot(light_normal), 0.0f);
      const float weight = std::max(direction.dot(at[i].normal), 0.0f) * sent / distance2;
      if (!(weight > 0)) continue;
      expected += double(weight);
      if (!(direction.dot(at[i].geometric_normal) > 0)) continue;
      const Vec3 origin = trace::Tracer::offsetOrigin(at[i].position, at[i].geometric_normal, direction);
      const Vec3 from_light = trace::Tracer::offsetOrigin(target, light_normal, -direction);
      rays_.push_back({.origin = origin, .direction = from_light - origin, .t_max = 1.0f - 1e-4f, .key = mixBits(combineKeys(index, i))});
      weight_.push_back(weight);
    }
    if (!(expected > 0)) return Vec3d(0.0);
    visibility_.resize(rays_.size());
    evaluation_.tracer.transmittance(rays_, visibility_);
    double seen = 0;
    for (size_t i = 0; i < rays_.size(); ++i) seen += double(weight_[i]) * double(visibility_[i]);
    return exact * (seen / expected / double(points_));
  }

  const VplEvaluation& evaluation_;
  const std::vector<lw_virtual_light>& lights_;
  uint32_t points_;
  float metres_;
  std::vector<trace::Ray> rays_;
  std::vector<float> weight_, visibility_;
};

}  // namespace

std::vector<Rgb> evaluateVplOnCpu(const VplEvaluation& evaluation) {
  lw_virtual_lights* raw = nullptr;
  evaluation.container.check(lw_virtual_lights_load(evaluation.container.get(), &raw));
  const std::unique_ptr<lw_virtual_lights, Release> handle(raw);
  lw_virtual_lights_info info;
  evaluation.container.check(lw_virtual_lights_get_info(raw, &info));
  std::vector<lw_virtual_light> lights;
  for (uint32_t i = 0; i < info.lights; ++i) {
    lw_virtual_light light;
    evaluation.container.check(lw_virtual_lights_get(raw, i, &light));
    const bool direct = light.bounce == 0;
    if (evaluation.component == transport::Component::total || direct == (evaluation.component == transport::Component::direct))
      lights.push_back(light);
  }
  const auto& slots = evaluation.scene.atlas.slots;
  std::vector<Rgb> irradiance_rgb(slots.size(), Rgb(0.0f));
  std::atomic<size_t> done = 0;
  // Each light has its own points: with many of them, few of each are enough.
  const uint32_t points = std::max(evaluation.samples / 16, kLeastPoints);
  parallelFor(slots.size(), 16, evaluation.threads, evaluation.cancel, [&](size_t begin, size_t end) {
    TexelLight light(evaluation, lights, points);
    for (size_t i = begin; i < end; ++i) irradiance_rgb[i] = light.of(slots[i]);
    evaluation.progress(double(done += end - begin) / double(slots.size()));
  });
  return irradiance_rgb;
}

}  // namespace lightwell::cli
