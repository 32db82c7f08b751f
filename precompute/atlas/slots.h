// What a texel's surface is like on the whole: position, normal, colour.
#pragma once
#include "precompute/atlas/atlas.h"

namespace lightwell::atlas {

/// Fills position, normal, albedo, emission and double_sided of every slot from its patches. Textures are averaged over the texel's
/// surface with samples as dense as their own texels, at most about 64 a slot; where a surface is partly cut out or transparent,
/// its colour is the mean over what is there (weighted by alpha), as a ray that meets it sees it.
void fillSlots(const scene::Scene& scene, Atlas& atlas, int threads);

}  // namespace lightwell::atlas
