// Light at the entry points and its averages over clusters.
#include <algorithm>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/light.h"
#include "runtime/src/prm.h"

using namespace lightwell::runtime;

namespace {

/// Collects the entry points that a light could reach, and asks the caller about them 256 at a time.
class ShadowBatch {
 public:
  ShadowBatch(lw_visibility_fn visibility, void* user, float* sum_rgb) : visibility_(visibility), user_(user), sum_rgb_(sum_rgb) {}
  ~ShadowBatch() { flush(); }

  void add(const lw_shadow_ray& ray, const float* irradiance_rgb) {
    rays_[count_] = ray;
    std::memcpy(irradiance_rgb_[count_], irradiance_rgb, sizeof irradiance_rgb_[0]);
    if (++count_ == kRays) flush();
  }

 private:
  static constexpr uint32_t kRays = 256;

  void flush() {
    float visible[kRays];
    std::fill_n(visible, kRays, 1.0f);
    if (visibility_ && count_) visibility_(user_, rays_, count_, visible);
    for (uint32_t i = 0; i < count_; ++i) {
      const float v = visible[i] > 0 ? std::min(visible[i], 1.0f) : 0.0f;
      for (int k = 0; k < 3; ++k) sum_rgb_[size_t(rays_[i].entry) * 3 + k] += v * irradiance_rgb_[i][k];
    }
    count_ = 0;
  }

  lw_visibility_fn visibility_;
  void* user_;
  float* sum_rgb_;
  uint32_t count_ = 0;
  lw_shadow_ray rays_[kRays];
  float irradiance_rgb_[kRays][3];
};

}  // namespace

lw_result lw_prm_entry_irradiance(const lw_prm* prm, const lw_light* lights, uint32_t light_count, lw_visibility_fn visibility, void* user,
                                  float* entry_irradiance_rgb) {
  if (!prm || !entry_irradiance_rgb || (light_count && !lights)) return LW_INVALID_ARGUMENT;
  const uint32_t entries = prm->header.entries;
  PackedLight light;
  for (uint32_t l = 0; l < light_count; ++l)
    if (const char* reason = packLight(lights[l], light)) return prm->host.fail(LW_INVALID_ARGUMENT, "light %u: %s", l, reason);
  std::memset(entry_irradiance_rgb, 0, size_t(entries) * 3 * sizeof(float));
  for (uint32_t l = 0; l < light_count; ++l) {
    packLight(lights[l], light);
    ShadowBatch batch(visibility, user, entry_irradiance_rgb);
    for (uint32_t e = 0; e < entries; ++e) {
      lw_shadow_ray ray;
      float irradiance_rgb[3];
      const float *position = &prm->entry_position_m[size_t(e) * 3], *normal = &prm->entry_normal[size_t(e) * 3];
      if (!lightIrradiance(light, position, normal, irradiance_rgb, ray.direction, ray.distance_m)) continue;
      if (!prm->entry_rectangle.empty() && !isType(light, LW_LIGHT_DIRECTIONAL)) {
        const float to_light_m[3] = {light.position_m[0] - position[0], light.position_m[1] - position[1], light.position_m[2] - position[2]};
        const float gain = rectangleGain(to_light_m, normal, &prm->entry_rectangle[size_t(e) * 3]);
        for (float& v : irradiance_rgb) v = std::min(v * gain, kMaxIrradiance);
      }
      std::memcpy(ray.origin_m, position, sizeof ray.origin_m);
      std::memcpy(ray.normal, normal, sizeof ray.normal);
      ray.entry = e;
      batch.add(ray, irradiance_rgb);
    }
  }
  return LW_OK;
}

lw_result lw_prm_cluster_irradiance(const lw_prm* prm, const float* entry_irradiance_rgb, float* cluster_irradiance_rgb) {
  if (!prm || !entry_irradiance_rgb || !cluster_irradiance_rgb) return LW_INVALID_ARGUMENT;
  for (uint32_t c = 0; c < prm->header.clusters; ++c) {
    float sum[3] = {};
    for (uint32_t e = prm->cluster_first_entry[c]; e < prm->cluster_first_entry[c + 1]; ++e)
      for (int k = 0; k < 3; ++k) sum[k] += prm->entry_weight[e] * entry_irradiance_rgb[size_t(e) * 3 + k];
    std::memcpy(&cluster_irradiance_rgb[size_t(c) * 3], sum, sizeof sum);
  }
  return LW_OK;
}
