// Where moving lights may be: the distribution that bases are fitted to and that errors are measured over.
#pragma once
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"

namespace lightwell::transport {

/// A point light of 1 cd in every channel, with its distance to the surface below it.
struct PriorLight {
  scene::Light light;
  float surface_distance_m = 0;  // along the normal of the point that it was raised from
};

/// The "hundred lights" distribution: a point uniform by area on the surfaces, raised along its normal by 10 to 90 % of the free distance (at most
/// 6 m). Intensity is 1 cd (per metres_per_unit²). Deterministic in `seed`; light i does not depend on `count`.
std::vector<PriorLight> samplePriorLights(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint32_t count, uint64_t seed);

}  // namespace lightwell::transport
