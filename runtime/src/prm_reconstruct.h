// From a block's sums to its texels, and what does not depend on the lights.
#pragma once
#include <algorithm>
#include <cfloat>

#include "runtime/src/prm.h"

namespace lightwell::runtime {

/// Irradiance that may be shown: finite, not negative.
inline float sane(float v) { return v > 0.0f ? std::min(v, FLT_MAX) : 0.0f; }

/// Writes the texels of a block. `basis`: its maps. `sums`: [rank][3]. Returns where the next block's maps are.
const int8_t* reconstructBlock(const lw_prm& prm, uint32_t block, const int8_t* basis, const float* sums, float* atlas_rgba);

/// Adds emitters and sky, as options ask, to the values [first, end).
void addConstants(const lw_prm& prm, const lw_prm_options& options, uint32_t first, uint32_t end, float* atlas_rgba);

}  // namespace lightwell::runtime
