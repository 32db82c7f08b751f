// Things that move and take ambient light from what is near, as spheres.
#pragma once
#include "runtime/src/host.h"

namespace lightwell::runtime {

/// The cosine-weighted share of the hemisphere about `normal` (unit) at `position_m` that a sphere fills, 0 to 1; 1 inside of it.
float blockedShare(const lw_blocker& blocker, const float* position_m, const float* normal);
/// What is left of light from all around, by channel: what passes the blockers and what they reflect of the same light.
void keptLight(const lw_blocker* blockers, uint32_t count, const float* position_m, const float* normal, float* kept_rgb);
/// Null, or what is wrong with the numbers.
const char* checkBlocker(const lw_blocker& blocker);

}  // namespace lightwell::runtime
