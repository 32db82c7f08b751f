#include "precompute/transport/lightmap/direct_sampler.h"

#include <algorithm>
#include <cmath>

namespace lightwell::transport {
namespace {

constexpr uint64_t kDirectStream = 5ull << 40;
constexpr size_t kBatchRays = 4096;
constexpr float kByLot = 0.25f;  // share of rays to emitters that are not picked by what these give
constexpr float kSegmentEnd = 1.0f - 0x1p-16f;  // a shadow segment stops short of the lamp itself
enum Dimension : uint32_t { kPatch = 0, kPlace = 1, kLamp = 2, kEmitter = 3, kOnEmitter = 4 };

/// Channel by channel: emitters of different colours have shadows of different places.
Vec3d visibleShare(const Vec3d& exact_rgb, const Vec3d& expected_rgb, const Vec3d& arrived_rgb) {
  Vec3d rgb(0.0);
  for (int c = 0; c < 3; ++c)
    if (expected_rgb[c] > 0) rgb[c] = exact_rgb[c] * (arrived_rgb[c] / expected_rgb[c]);
  return rgb;
}

}  // namespace

Vec3d DirectSums::mean(uint32_t first, uint32_t end) const {
  Vec3d lamps_rgb(0.0), exact_rgb(0.0), expected_rgb(0.0), arrived_rgb(0.0), near_expected_rgb(0.0), near_arrived_rgb(0.0);
  for (uint32_t g = first; g < end; ++g) {
    lamps_rgb += group[g].lamps_rgb, exact_rgb += group[g].emitters_rgb;
    expected_rgb += group[g].expected_rgb, arrived_rgb += group[g].arrived_rgb;
    near_expected_rgb += group[g].near_expected_rgb, near_arrived_rgb += group[g].near_arrived_rgb;
  }
  return (lamps_rgb + visibleShare(exact_rgb, expected_rgb, arrived_rgb)) / double((end - first) * count) +
         visibleShare(near.irradiance_rgb, near_expected_rgb, near_arrived_rgb);
}

double DirectSums::standardError() const {
  const double middle = luminance(Rgb(mean()));
  double scatter = 0;
  for (uint32_t g = 0; g < kSampleGroups; ++g) scatter += std::pow(luminance(Rgb(mean(g, g + 1))) - middle, 2.0);
  return std::sqrt(scatter / (kSampleGroups * (kSampleGroups - 1)));
}

Vec3 DirectSums::gradient() const {
  Vec3d lamps(0.0), emitters(0.0), exact_rgb(0.0), expected_rgb(0.0), near_gradient(0.0), near_expected_rgb(0.0);
  for (const Group& g : group) {
    lamps += g.lamps_gradient, emitters += g.emitters_gradient, exact_rgb += g.emitters_rgb, expected_rgb += g.expected_rgb;
    near_gradient += g.near_gradient, near_expected_rgb += g.near_expected_rgb;
  }
  const double expected = luminance(Rgb(expected_rgb));
  if (expected > 0) lamps += emitters * (luminance(Rgb(exact_rgb)) / expected);
  Vec3d mean = lamps / double(kSampleGroups * count);
  const double near_expected = luminance(Rgb(near_expected_rgb));
  if (near_expected > 0) mean += near_gradient * (luminance(Rgb(near.irradiance_rgb)) / near_expected);
  return Vec3(mean);
}

void DirectSampler::sample(uint32_t count, std::span<DirectSums*> list) {
  for (DirectSums* sums : list) {
    if (sums->count == 0)
      sums->near = nearLamp(context_.scene.mesh, context_.atlas, context_.lamps, context_.atlas.slots[context_.sides.slot[sums->side]], context_.sides.isBack(sums->side));
    for (uint32_t i = sums->count; i < count; ++i)
      for (uint32_t group = 0; group < kSampleGroups; ++group) {
        const uint64_t owner = combineKeys(uint64_t(sums->side) + kDirectStream, group);
        const Sampler sampler(context_.seed, owner);
        const auto point = sampleSide(context_.scene.mesh, context_.atlas, context_.sides, sums->side, sampler.get1D(i, kPatch), sampler.get2D(i, kPlace));
        add(sums->group[group], {point.position, point.normal, point.geometric_normal, sampler, i}, owner, sums->near.light);
      }
    sums->count = std::max(sums->count, count);
    if (lamp_rays_.size() + emitter_rays_.size() >= kBatchRays) flush();
  }
  flush();
}

std::vector<Rgb> DirectSampler::irradiance(std::span<const Receiver> receivers) {
  std::vector<DirectSums::Group> groups(receivers.size());
  for (size_t i = 0; i < receivers.size(); ++i) add(groups[i], receivers[i], kDirectStream, kNone);
  flush();
  std::vector<Rgb> irradiance_rgb;
  for (const DirectSums::Group& group : groups) irradiance_rgb.emplace_back(group.lamps_rgb + group.arrived_rgb);
  return irradiance_rgb;
}

void DirectSampler::add(DirectSums::Group& group, const Receiver& at, uint64_t key, uint32_t near_lamp) {
  lamp_samples_.clear();
  if (near_lamp != kNone) {
    Vec3 to_light;
    float distance;
    group.near_expected_rgb += Vec3d(scene::lightIrradiance(context_.lamps.lights()[near_lamp], at.position, at.geometric_normal, to_light, distance));
  }
  context_.lamps.sample(at.position, at.normal, true, at.sampler.get1D(at.sample, kLamp), lamp_samples_);
  for (const PunctualLights::Sample& lamp : lamp_samples_) {
    if (!(lamp.to_light.dot(at.geometric_normal) > 0.0f)) continue;
    const Vec3 origin = trace::Tracer::offsetOrigin(at.position, at.geometric_normal, lamp.to_light);
    if (std::isfinite(lamp.distance))
      lamp_rays_.push_back({origin, at.position + lamp.to_light * lamp.distance - origin, 0.0f, kSegmentEnd});
    else
      lamp_rays_.push_back({origin, lamp.to_light});
    lamp_arrivals_.push_back({&group, lamp.irradiance_rgb, context_.tilt ? context_.tilt->gradient(at.normal, lamp.to_light) : Vec3(0.0f), kNone, lamp.light == near_lamp});
  }
  if (!context_.emitters.empty()) aimAtEmitter(group, at, key);
}

/// All emitters' exact light, and a ray to one of them, picked by what it gives; now and then by lot, since what gives most may be hidden.
void DirectSampler::aimAtEmitter(DirectSums::Group& group, const Receiver& at, uint64_t key) {
  const PlainEmitters& emitters = context_.emitters;
  cumulative_.resize(emitters.count());
  float total = 0;
  uint32_t facing = 0;
  for (uint32_t i = 0; i < emitters.count(); ++i) {
    const Rgb irradiance_rgb = emitters.radiance(i) * emitters.irradiance(i, at.position, at.normal);
    group.emitters_rgb += Vec3d(irradiance_rgb);
    cumulative_[i] = luminance(irradiance_rgb);
    total += cumulative_[i], facing += cumulative_[i] > 0.0f;
  }
  if (!(total > 0.0f)) return;
  float sum = 0;
  for (float& at_emitter : cumulative_) at_emitter = sum += at_emitter > 0.0f ? (1 - kByLot) * (at_emitter / total) + kByLot / float(facing) : 0.0f;
  const float target = at.sampler.get1D(at.sample, kEmitter) * sum;
  uint32_t picked = uint32_t(std::upper_bound(cumulative_.begin(), cumulative_.end(), target) - cumulative_.begin());
  picked = std::min(picked, emitters.count() - 1);
  const float share = (cumulative_[picked] - (picked ? cumulative_[picked - 1] : 0.0f)) / sum;
  if (!(share > 0.0f)) return;
  const PlainEmitters::Sample ray = emitters.sample(picked, at.position, at.normal, at.sampler.get2D(at.sample, kOnEmitter));
  if (!(ray.weight > 0.0f)) return;
  const Rgb irradiance_rgb = emitters.radiance(picked) * (ray.weight / share);
  group.expected_rgb += Vec3d(irradiance_rgb);
  if (!(ray.direction.dot(at.geometric_normal) > 0.0f)) return;
  emitter_rays_.push_back({.origin = trace::Tracer::offsetOrigin(at.position, at.geometric_normal, ray.direction), .direction = ray.direction,
                           .key = mixBits(combineKeys(key, at.sample))});
  emitter_arrivals_.push_back({&group, irradiance_rgb, context_.tilt ? context_.tilt->gradient(at.normal, ray.direction) : Vec3(0.0f), emitters.triangle(picked)});
}

void DirectSampler::flush() {
  if (context_.cancel) context_.cancel->check();
  transmittance_.resize(lamp_rays_.size());
  context_.tracer.transmittance(lamp_rays_, transmittance_);
  for (size_t i = 0; i < lamp_arrivals_.size(); ++i) {
    const Rgb arrived_rgb = lamp_arrivals_[i].irradiance_rgb * transmittance_[i];
    DirectSums::Group& group = *lamp_arrivals_[i].group;
    (lamp_arrivals_[i].near ? group.near_arrived_rgb : group.lamps_rgb) += Vec3d(arrived_rgb);
    (lamp_arrivals_[i].near ? group.near_gradient : group.lamps_gradient) += Vec3d(lamp_arrivals_[i].gradient) * double(luminance(arrived_rgb));
  }
  hits_.resize(emitter_rays_.size());
  context_.tracer.closest(emitter_rays_, hits_);
  for (size_t i = 0; i < emitter_arrivals_.size(); ++i) {
    if (hits_[i].triangle != emitter_arrivals_[i].triangle) continue;
    emitter_arrivals_[i].group->arrived_rgb += Vec3d(emitter_arrivals_[i].irradiance_rgb);
    emitter_arrivals_[i].group->emitters_gradient += Vec3d(emitter_arrivals_[i].gradient) * double(luminance(emitter_arrivals_[i].irradiance_rgb));
  }
  lamp_rays_.clear(), lamp_arrivals_.clear(), emitter_rays_.clear(), emitter_arrivals_.clear();
}

}  // namespace lightwell::transport
