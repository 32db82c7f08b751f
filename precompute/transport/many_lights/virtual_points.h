// Virtual point lights: where light paths from the lamps and emitters of a scene meet its surfaces, with the light that leaves there.
//
// Keller, "Instant Radiosity" (SIGGRAPH 1997), with every light source and every reflection kept apart: Luksch et al., "Fast Light-Map
// Computation with Virtual Polygon Lights" (I3D 2013), section 5.1.
#pragma once
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/core/diagnostics.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/environment/sky_light.h"

namespace lightwell::transport {

struct VirtualPoint {
  Vec3 position;    // internal units
  Vec3 normal;      // unit, geometric, on the side that shines
  Rgb power_rgb;    // of all light that leaves, cosine-distributed: irradiance × internal units²
  uint32_t source;  // index into the lights; their number stands for all emitters, and one more for the sky
  uint32_t bounce;  // reflections so far; 0 only on emitters
};

struct LightPathOptions {
  uint32_t paths = 20000;  // from all sources, by their power; fewer where surfaces are so bright that paths hardly end
  uint32_t bounces = 0;    // reflections at most; 0: until a path ends by itself
  uint64_t seed = 1;
};

class LightPaths {
 public:
  /// Everything given must outlive this; `lights` in internal units, `sky` may be null.
  LightPaths(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const std::vector<scene::Light>& lights,
             const SkyLight* sky, const LightPathOptions& options);

  uint32_t count() const { return sources_.empty() ? 0 : sources_.back().end_path; }
  /// The virtual points of paths [first, end), path by path. The power of source and bounce, summed over all paths, is an unbiased
  /// estimate.
  std::vector<VirtualPoint> trace(uint32_t first, uint32_t end, const CancelFlag* cancel) const;

 private:
  struct Source {
    uint32_t index = 0, first_path = 0, end_path = 0;
    Rgb path_power_rgb{0.0f};
  };
  struct Start;
  double reflectedShare(uint32_t index) const;
  Start startOfSky(const Source& source, const Vec2& place, const Vec2& direction) const;
  Start startOfLamp(const Source& source, const Vec2& place, const Vec2& direction) const;
  Start startOnEmitter(const Source& source, float pick, float side, float patch, const Vec2& place, const Vec2& direction) const;
  void tracePath(const Source& source, uint32_t path, std::vector<VirtualPoint>& points) const;

  const scene::Scene& scene_;
  const atlas::Atlas& atlas_;
  const trace::Tracer& tracer_;
  const std::vector<scene::Light>& lights_;
  const SkyLight* sky_;
  uint64_t seed_;
  uint32_t most_bounces_;
  Vec3 middle_{0.0f};
  float radius_ = 0;  // of a sphere around all surfaces, internal units
  std::vector<uint32_t> emitting_slot_;
  std::vector<double> emitting_cdf_;  // luminous flux of emitting slots, summed
  std::vector<Source> sources_;       // those that shine
};

}  // namespace lightwell::transport
