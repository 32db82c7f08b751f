// Many paths advanced together, one vertex at a time, so that their rays reach the tracer in long batches.
#pragma once
#include <functional>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/core/random.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/environment/sky_light.h"
#include "precompute/transport/reference/emitters.h"
#include "precompute/transport/reference/punctual.h"
#include "precompute/transport/reference/reference.h"

namespace lightwell::transport {

/// What every path needs to know; all of it outlives the paths.
struct PathContext {
  const scene::Scene& scene;
  const atlas::Atlas& atlas;
  const trace::Tracer& tracer;
  const Emitters& emitters;
  const PunctualLights& punctual;
  const SkyLight* sky;  // null: none
  Component component;
  const CancelFlag* cancel;
  uint32_t most_bounces = kNone;  // reflections after which a path ends
};

/// A place where irradiance is received.
struct PathVertex {
  Vec3 position;          // internal units
  Vec3 shading_normal;    // unit; irradiance is about it
  Vec3 geometric_normal;  // unit, on the lit side; light from below is not received
};

/// A path that starts on the surface of a slot, on its front or its back. Its random numbers are the points number `sample` of `sampler`.
struct PathStart {
  uint32_t slot;
  uint32_t sample;
  Sampler sampler;
  uint64_t key;  // of the path among all: decides which rays pass through blended surfaces
  bool back = false;
};

class PathBatch {
 public:
  explicit PathBatch(const PathContext& context) : context_(context) {}

  /// Told of what arrives at starts[start] straight from a light, and from where (not a unit vector).
  using Arrival = std::function<void(uint32_t start, const Vec3& direction, const Rgb& irradiance_rgb)>;

  /// Traces all paths to their end. `irradiance_rgb[i]` is an unbiased estimate of the irradiance at the surface of starts[i]. `arrival`: for Component::direct only; may be null.
  void trace(const std::vector<PathStart>& starts, std::vector<Rgb>& irradiance_rgb, const Arrival* arrival = nullptr);

 private:
  struct Path {
    uint32_t index;      // into the starts
    uint32_t depth = 0;  // reflections so far
    Rgb throughput_rgb{1, 1, 1};  // of irradiance at this vertex to irradiance at the first one
    PathVertex vertex;
    float pdf_direction = 0;  // solid angle, of the ray on its way from this vertex
  };
  void aimAtLights(const Path& path, const PathStart& start);
  void aimAtEmitter(const Path& path, const PathStart& start);
  void aimAtSky(const Path& path, const PathStart& start);
  bool scatter(Path& path, const PathStart& start);
  Rgb escape(const Path& path, const Vec3& direction) const;
  bool arrive(Path& path, const PathStart& start, const trace::Hit& hit, Rgb& irradiance_rgb) const;

  const PathContext& context_;
  std::vector<Path> paths_;
  struct LightContribution {  // what arrives when nothing is in the way of the ray of the same number
    uint32_t path_index;
    Rgb irradiance_rgb;
  };
  struct EmitterContribution {  // what arrives when that ray meets this triangle first
    uint32_t path_index, triangle;
    Rgb irradiance_rgb;
  };
  std::vector<trace::Ray> rays_, light_rays_, emitter_rays_;
  std::vector<LightContribution> light_contributions_;
  std::vector<EmitterContribution> emitter_contributions_;
  std::vector<trace::Hit> hits_;
  std::vector<float> transmittance_;
  std::vector<PunctualLights::Sample> light_samples_;
};

}  // namespace lightwell::transport
