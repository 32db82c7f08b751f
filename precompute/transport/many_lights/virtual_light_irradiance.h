// What virtual lights give to the surfaces, as docs/format.md defines it.
#pragma once
#include <span>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/core/diagnostics.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/many_lights/virtual_lights.h"

namespace lightwell::transport {

/// Irradiance ÷ power, per internal unit², at a point with a unit normal when nothing is in the way.
double irradianceShare(const VirtualLight& light, const Vec3& position, const Vec3& normal);
/// A point of the light, uniform over its area (of a sphere: over a disk about its normal). `u` in [0, 1)².
Vec3 pointOnLight(const VirtualLight& light, const Vec2& u);

/// Irradiance of slots by all lights, shadowed: at points of each slot the exact irradiance by each light times what these points see of it, a ratio of two sums over the same rays (Heitz et al.,
/// "Combining Analytic Direct Illumination and Stochastic Shadows", I3D 2018). Of many thousands of lights a sample is looked at, by their power. A point gives at most what it would if it were as
/// large as its share of all surfaces.
class VirtualLightSampler {
 public:
  /// Everything given must outlive this.
  VirtualLightSampler(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, std::span<const VirtualLight> lights);

  /// An estimate for each of `slots`; independent for another seed. Throws Cancelled.
  std::vector<Rgb> irradiance(std::span<const uint32_t> slots, uint64_t seed, const CancelFlag& cancel) const;

  /// Rays for each slot, about.
  uint32_t rays() const { return looked_at_ * points_; }

 private:
  struct Chosen {
    uint32_t light;
    double weight;  // stands for so many
  };
  std::vector<Chosen> choose(float offset) const;
  Vec3d lightOf(const Chosen& chosen, std::span<const atlas::SurfacePoint> at, uint64_t key) const;

  const scene::Scene& scene_;
  const atlas::Atlas& atlas_;
  const trace::Tracer& tracer_;
  std::span<const VirtualLight> lights_;
  std::vector<double> cumulative_power_;
  double most_share_ = 0;  // of points: irradiance ÷ power
  uint32_t looked_at_ = 0, points_ = 0;
};

}  // namespace lightwell::transport
