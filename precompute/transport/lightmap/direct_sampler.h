// Light straight from lamps and plain emitters at points of the surface, one shadow ray for each light that is looked at.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "precompute/core/random.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/lightmap/near_lamp.h"
#include "precompute/transport/lightmap/plain_emitters.h"
#include "precompute/transport/lightmap/tilt.h"
#include "precompute/transport/reference/punctual.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

/// Samples come in groups, independently scrambled: their scatter tells the error.
inline constexpr uint32_t kSampleGroups = 4;

/// The samples of one side so far.
struct DirectSums {
  struct Group {
    Vec3d lamps_rgb{0, 0, 0};
    Vec3d emitters_rgb{0, 0, 0};                        // exact, as if nothing were in the way
    Vec3d expected_rgb{0, 0, 0}, arrived_rgb{0, 0, 0};  // of the rays to emitters: all, and those that arrived
    Vec3d near_expected_rgb{0, 0, 0}, near_arrived_rgb{0, 0, 0};  // of the near lamp: in front of the surface, and what arrived about its normal
    Vec3d lamps_gradient{0, 0, 0}, emitters_gradient{0, 0, 0}, near_gradient{0, 0, 0};  // weighted by luminance
  };
  uint32_t side = 0;
  uint32_t count = 0;  // of each group
  NearLamp near;       // from the first sample on
  std::array<Group, kSampleGroups> group{};

  /// Irradiance from the groups [first, end).
  Vec3d mean(uint32_t first = 0, uint32_t end = kSampleGroups) const;
  /// Of the luminance of `mean()`.
  double standardError() const;
  /// Irradiance times how it changes with the normal (tilt.h), in luminance.
  Vec3 gradient() const;
};

/// Emitters: exact irradiance times visible share, the latter as a ratio of two sums over the same rays (Heitz, Hill, McGuire, "Combining Analytic Direct Illumination and Stochastic Shadows",
/// I3D 2018). Neither unshadowed nor fully shadowed places have noise then, however near the emitter is. The same for a lamp that is near.
class DirectSampler {
 public:
  /// All of it outlives this. Either of the lights may be none.
  struct Context {
    const scene::Scene& scene;
    const atlas::Atlas& atlas;
    const trace::Tracer& tracer;
    const Sides& sides;
    const PunctualLights& lamps;
    const PlainEmitters& emitters;
    const TiltKernel* tilt;  // null: gradients are not wanted
    const CancelFlag* cancel;
    uint64_t seed;
  };
  explicit DirectSampler(const Context& context) : context_(context) {}

  /// Adds samples to all of `list`, until each group has `count`. What a side gets depends on nothing but its own counts.
  void sample(uint32_t count, std::span<DirectSums*> list);

  /// A place anywhere on the surface; its random numbers are the points number `sample` of `sampler`.
  struct Receiver {
    Vec3 position, normal, geometric_normal;
    Sampler sampler;
    uint32_t sample;
  };
  /// An unbiased estimate of irradiance at each of them, from one ray to each light that is looked at.
  std::vector<Rgb> irradiance(std::span<const Receiver> receivers);

 private:
  /// `near_lamp`: goes to the group's sums of its own.
  void add(DirectSums::Group& group, const Receiver& at, uint64_t key, uint32_t near_lamp);
  void aimAtEmitter(DirectSums::Group& group, const Receiver& at, uint64_t key);
  void flush();

  struct Arrival {
    DirectSums::Group* group;
    Rgb irradiance_rgb;
    Vec3 gradient;  // unit irradiance
    uint32_t triangle;  // that the ray must meet; unused for lamps
    bool near = false;  // from the near lamp
  };
  const Context& context_;
  std::vector<trace::Ray> lamp_rays_, emitter_rays_;
  std::vector<Arrival> lamp_arrivals_, emitter_arrivals_;
  std::vector<float> transmittance_;
  std::vector<trace::Hit> hits_;
  std::vector<PunctualLights::Sample> lamp_samples_;
  std::vector<float> cumulative_;
};

}  // namespace lightwell::transport
