// Light-map coordinates for objects that have none, or none that are sound.
#pragma once
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/atlas/uv_check.h"

namespace lightwell::atlas {

/// Generates coordinates for the objects whose check found a problem, keeps those of the others exactly, and returns one per vertex of the
/// mesh, whose vertices are duplicated along seams. Sets `atlas_unwrapped` when any were generated. Every reason goes to `diagnostics`.
/// Throws InputError when the charts cannot fit.
std::vector<Vec2> layOut(scene::Scene& scene, const UvCheck& check, const AtlasOptions& options, Diagnostics& diagnostics, int threads,
                         bool& atlas_unwrapped);

}  // namespace lightwell::atlas
