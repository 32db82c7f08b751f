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

}  // namespace lightwell::plan
