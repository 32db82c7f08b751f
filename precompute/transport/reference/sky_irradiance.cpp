#include "precompute/transport/reference/sky_irradiance.h"

#include "precompute/core/parallel.h"
#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kSlotStream = 1ull << 41, kPointStream = 1ull << 42;  // owners of random streams never meet
enum Dimension : uint32_t { kPatch, kPlace, kCosine, kSky };

/// Collects the shadow rays of one receiver and what they bring when nothing is in the way.
class Receiver {
 public:
  explicit Receiver(const SkyScene& scene) : scene_(scene) {}

  void clear() { rays_.clear(), irradiance_rgb_.clear(); }

  void aim(const atlas::SurfacePoint& point, const Vec2& u_cosine, const Vec2& u_sky) {
    Vec3 tangent, bitangent;
    orthonormalBasis(point.normal, tangent, bitangent);
    const Vec3 local = sampleCosineHemisphere(u_cosine);
    const Vec3 direction = (tangent * local.x + bitangent * local.y + point.normal * local.z).normalized();
    const SkyLight::Value seen = scene_.sky.at(direction);
    add(point, direction, seen.radiance_rgb, seen.pdf_solid_angle);
    const SkyLight::Sample picked = scene_.sky.sample(u_sky);
    add(point, picked.direction, picked.radiance_rgb, picked.pdf_solid_angle);
  }

  Rgb mean() {
    transmittance_.resize(rays_.size());
    scene_.tracer.transmittance(rays_, transmittance_);
    Vec3d sum(0.0);
    for (size_t i = 0; i < rays_.size(); ++i) sum += Vec3d(irradiance_rgb_[i] * transmittance_[i]);
    return Rgb(sum / scene_.samples);
  }

 private:
  /// Both kinds of samples have the same weight over density: 1 / (pdf_sky + pdf_cosine).
  void add(const atlas::SurfacePoint& point, const Vec3& direction, const Rgb& radiance_rgb, float pdf_sky) {
    const float cosine = direction.dot(point.normal);
    if (!(cosine > 0.0f && direction.dot(point.geometric_normal) > 0.0f && maxComponent(radiance_rgb) > 0.0f)) return;
    rays_.push_back({.origin = trace::Tracer::offsetOrigin(point.position, point.geometric_normal, direction), .direction = direction});
    irradiance_rgb_.push_back(radiance_rgb * (cosine / (pdf_sky + cosine / kPi)));
  }

  const SkyScene& scene_;
  std::vector<trace::Ray> rays_;
  std::vector<Rgb> irradiance_rgb_;
  std::vector<float> transmittance_;
};

}  // namespace

std::vector<Rgb> skyOnSlots(const SkyScene& scene, size_t first, size_t end) {
  std::vector<Rgb> result;
  Receiver receiver(scene);
  for (size_t slot = first; slot < end; ++slot) {
    const Sampler sampler(scene.seed, kSlotStream + scene.atlas.slots[slot].texel);
    receiver.clear();
    for (uint32_t i = 0; i < scene.samples; ++i)
      receiver.aim(atlas::sampleSlot(scene.mesh, scene.atlas, scene.atlas.slots[slot], sampler.get1D(i, kPatch), sampler.get2D(i, kPlace)),
                   sampler.get2D(i, kCosine), sampler.get2D(i, kSky));
    result.push_back(receiver.mean());
  }
  return result;
}

std::vector<Rgb> skyAtPoints(const SkyScene& scene, std::span<const Vec3> position, std::span<const Vec3> normal, int threads,
                             const CancelFlag* cancel) {
  std::vector<Rgb> result(position.size());
  parallelFor(position.size(), 64, threads, cancel, [&](size_t begin, size_t end) {
    Receiver receiver(scene);
    for (size_t i = begin; i < end; ++i) {
      const Sampler sampler(scene.seed, kPointStream + i);
      const atlas::SurfacePoint point{.position = position[i], .normal = normal[i], .geometric_normal = normal[i]};
      receiver.clear();
      for (uint32_t s = 0; s < scene.samples; ++s) receiver.aim(point, sampler.get2D(s, kCosine), sampler.get2D(s, kSky));
      result[i] = receiver.mean();
    }
  });
  return result;
}

}  // namespace lightwell::transport
