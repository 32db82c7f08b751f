// Where moving lights may be: the distribution that bases are fitted to and that errors are measured over.
#pragma once
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"

namespace lightwell::transport {

struct LightPrior {
  enum class Places {
    anywhere,  // in the air over surfaces
    ceilings,  // in the air under surfaces that look down, nearer to them than to what is below
    sun,       // directional, from anywhere above the horizon
    lamps,     // where the scene's punctual lights are; what they shine with may change
    paths,     // along lines through the scene
  };
  Places places = Places::anywhere;
  std::vector<std::vector<Vec3>> paths;  // internal units; each of one point (a place) or more (a line through them)
};

/// One light, 1 in every channel (candela per metres_per_unit², lux for directional ones).
struct PriorLight {
  scene::Light light;
  float surface_distance_m = 0;  // along the normal of the point that it was raised from; infinite without such a point
};

/// `anywhere` is the "hundred lights" distribution: a point uniform by area on the surfaces, raised along its normal by 10 to 90 % of the free distance (at
/// most 6 m); `ceilings`: by 5 to 35 %, from surfaces that look down. Fewer than `count` where there is no more room, and for `lamps` at most one for each.
/// Deterministic in `seed`; light i does not depend on `count`.
std::vector<PriorLight> samplePriorLights(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const LightPrior& prior, uint32_t count,
                                          uint64_t seed);

inline std::vector<PriorLight> samplePriorLights(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint32_t count, uint64_t seed) {
  return samplePriorLights(scene, atlas, tracer, {}, count, seed);
}

}  // namespace lightwell::transport
