// Closed rooms that stay dark: pockets between walls, boxes that nobody opens. Nothing is stored for them.
#pragma once
#include "precompute/transport/radiosity/links.h"

namespace lightwell::transport {

/// Empties the rows of patches that exchange light, through doors too, with less than a hundredth of the scene's surface, where no lamp of the scene shines and
/// nothing emits. A scene without lamps and emitters is left as it is: its light is the game's, and may be anywhere. Returns the number of patches that had rows.
uint32_t emptySealedRooms(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches,
                          const PatchTree& tree, uint64_t seed, LinkValues& links);

}  // namespace lightwell::transport
