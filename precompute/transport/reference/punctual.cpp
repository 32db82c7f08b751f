#include "precompute/transport/reference/punctual.h"

#include <algorithm>
#include <array>

namespace lightwell::transport {
namespace {
constexpr size_t kFew = 8;
constexpr float kConeSlack = 1e-3f;  // radians
}  // namespace

PunctualLights::PunctualLights(const std::vector<scene::Light>& lights) : lights_(lights) {
  for (uint32_t i = 0; i < lights.size(); ++i)
    if (luminance(lights[i].intensity) > 0.0f)
      (lights[i].type == scene::LightType::directional ? directional_ : local_).push_back(i);
  for (std::vector<uint32_t>* group : {&local_, &directional_}) {
    if (group->size() > kFew) continue;
    few_.insert(few_.end(), group->begin(), group->end());
    group->clear();
  }
  std::vector<LightBounds> bounds(local_.size());
  for (size_t i = 0; i < local_.size(); ++i) {
    const scene::Light& light = lights[local_[i]];
    const bool spot = light.type == scene::LightType::spot;
    bounds[i].box = Box3(light.position);
    bounds[i].axis = light.direction;
    bounds[i].normal_spread = spot ? std::min(light.inner_cone_angle, kPi) : kPi;
    bounds[i].emission_spread = spot ? std::max(0.0f, light.outer_cone_angle - light.inner_cone_angle) + kConeSlack : kPi / 2;
    bounds[i].power = luminance(light.intensity);
  }
  tree_ = LightTree(bounds);
  double sum = 0;
  for (const uint32_t i : directional_) directional_cdf_.push_back(sum += luminance(lights[i].intensity));
}

void PunctualLights::sample(const Vec3& position, const Vec3& normal, bool all_of_few, float u, std::vector<Sample>& samples) const {
  const auto append = [&](uint32_t light, float probability) {
    Sample sample;
    sample.irradiance_rgb = scene::lightIrradiance(lights_[light], position, normal, sample.to_light, sample.distance) / probability;
    sample.light = light;
    if (maxComponent(sample.irradiance_rgb) > 0.0f) samples.push_back(sample);
  };

  if (!few_.empty()) {
    const size_t first = samples.size();
    for (const uint32_t light : few_) append(light, 1.0f);
    if (const size_t count = samples.size() - first; !all_of_few && count > 1) {
      std::array<float, 2 * kFew> cumulative;
      float total = 0;
      for (size_t i = 0; i < count; ++i) cumulative[i] = total += luminance(samples[first + i].irradiance_rgb);
      size_t picked = 0;
      while (picked + 1 < count && u * total >= cumulative[picked]) ++picked;
      const float share = cumulative[picked] - (picked ? cumulative[picked - 1] : 0.0f);
      samples[first] = samples[first + picked];
      samples[first].irradiance_rgb *= total / share;
      samples.resize(first + (share > 0.0f ? 1 : 0));
    }
  }
  if (const LightTree::Pick pick = tree_.pick(position, normal, u); pick.item != kNone && pick.probability > 0.0f)
    append(local_[pick.item], pick.probability);
  if (!directional_cdf_.empty()) {
    const double target = double(u) * directional_cdf_.back();
    const size_t i = std::min<size_t>(std::upper_bound(directional_cdf_.begin(), directional_cdf_.end(), target) - directional_cdf_.begin(),
                                      directional_cdf_.size() - 1);
    const double share = directional_cdf_[i] - (i ? directional_cdf_[i - 1] : 0.0);
    append(directional_[i], float(share / directional_cdf_.back()));
  }
}

}  // namespace lightwell::transport
