// Emitting triangles whose light on a point can be written down: few, without a texture of emission.
#pragma once
#include <vector>

#include "precompute/scene/scene.h"

namespace lightwell::transport {

class PlainEmitters {
 public:
  /// Empty when the scene has emitters of another kind, or more than a few: then all of them are sampled instead (emitters.h).
  explicit PlainEmitters(const scene::Scene& scene);

  bool empty() const { return triangles_.empty(); }
  uint32_t count() const { return uint32_t(triangles_.size()); }
  uint32_t triangle(uint32_t emitter) const { return triangles_[emitter].triangle; }
  const Rgb& radiance(uint32_t emitter) const { return triangles_[emitter].radiance_rgb; }

  /// What an emitter of radiance 1 gives to a point with the unit normal `normal` when nothing is in the way: Lambert's formula for the part above the horizon. In [0, π].
  float irradiance(uint32_t emitter, const Vec3& position, const Vec3& normal) const;

  struct Sample {
    Vec3 direction;  // unit
    float weight;    // cosine at the receiver ÷ density in solid angle: its mean is `irradiance`; zero when nothing comes from there
  };
  /// A direction to a point of the emitter, uniform in solid angle (Arvo, "Stratified Sampling of Spherical Triangles", 1995), of far ones uniform in area. `u` in [0, 1)².
  Sample sample(uint32_t emitter, const Vec3& position, const Vec3& normal, const Vec2& u) const;

 private:
  struct Triangle {
    uint32_t triangle;
    Vec3d corner[3];
    Vec3d normal;  // unit
    double area, size;
    Rgb radiance_rgb;
    bool double_sided;
  };
  std::vector<Triangle> triangles_;
};

}  // namespace lightwell::transport
