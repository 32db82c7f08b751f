// What a few thousand rays tell of a scene before anything is baked.
#pragma once
#include <cstdint>

#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"

namespace lightwell::plan {

struct SkyProbe {
  uint32_t rays = 0;  // cosine-distributed, from places uniform by area on the surfaces of the atlas
  uint32_t free = 0;  // of them: met no surface, or only the leaf of a portal
  /// A scene whose share of the sky is less than about 1 / rays is taken for closed.
  bool seesSky() const { return free > 0; }
};

inline constexpr uint32_t kProbingRays = 65536;

/// `atlas` with its slots; `tracer` with all portals shut.
SkyProbe probeSky(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint64_t seed);

/// How much indirect irradiance varies inside of the atlas's texels, at most about: mean over the surfaces, relative, in [0, 1]. (The mean: in corners, where R is nothing, the bound has no bound.) Bound of the split sphere (Ward, Rubinstein, Clear: "A Ray Tracing
/// Solution for Diffuse Interreflection"): over a distance d irradiance changes by (4/π) d / R of itself at most, R being the harmonic mean distance of what is seen; the root mean square of d in a square
/// texel of width w is w / √6. From kProbingRays rays, 16 from each place.
double probeVariation(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, uint64_t seed);

}  // namespace lightwell::plan
