// Ray tracing on Embree, in batches. The only place that knows Embree.
#pragma once
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "precompute/scene/scene.h"

namespace lightwell::trace {

struct Ray {
  Vec3 origin, direction;  // internal units; direction need not be unit for occlusion segments, must be unit for closest hits
  float t_min = 0, t_max = std::numeric_limits<float>::infinity();
  uint32_t key = 0;  // random key of this ray: decides stochastic passage through BLEND surfaces
};

struct Hit {
  uint32_t triangle = kNone;  // index into Scene::mesh.triangles; kNone: nothing hit
  float t = 0, u = 0, v = 0;  // distance; barycentrics (1 − u − v, u, v)
  bool front = true;          // the ray arrived on the counter-clockwise side
  Vec3 geometric_normal{0, 0, 0};  // unit, on the side the ray came from
};

/// Counters of rays traced so far. Counting does not depend on thread timing.
struct RayCounts {
  uint64_t closest = 0, occlusion = 0;
};

class Tracer {
 public:
  /// Builds the acceleration structure. `scene` must outlive the tracer and not change. MASK surfaces are cut out exactly,
  /// BLEND surfaces pass a ray with probability 1 − alpha (closest, keyed by Ray::key) or attenuate it (occlusion).
  /// `portal_open`: how far each of scene.portals is open, 0 to 1; rays meet what is left of their leaves, exactly. Empty: all are shut.
  explicit Tracer(const scene::Scene& scene, int threads = 0, std::vector<float> portal_open = {});
  ~Tracer();
  Tracer(const Tracer&) = delete;
  Tracer& operator=(const Tracer&) = delete;

  /// Nearest hits. rays.size() == hits.size(). Thread-safe. A hit depends on its ray alone, not on the rays beside it: Embree gets the rays
  /// one by one, which is as fast as packets and streams for incoherent rays. Segments that are empty, NaN, or infinite in origin or
  /// direction hit nothing.
  void closest(std::span<const Ray> rays, std::span<Hit> hits) const;

  /// Fraction of light that passes along origin + t * direction, t in (t_min, t_max): 0 occluded, 1 free.
  void transmittance(std::span<const Ray> rays, std::span<float> transmittance) const;

  RayCounts counts() const;

  /// A ray origin moved off the surface at `position` toward the side of `direction`, robustly for the magnitude of the coordinates.
  static Vec3 offsetOrigin(const Vec3& position, const Vec3& geometric_normal, const Vec3& direction);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace lightwell::trace
