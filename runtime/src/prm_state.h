// Radiance maps from frame to frame, for the library's own use.
#pragma once
#include "lightwell/lightwell_prm_state.h"

namespace lightwell::runtime {

/// lw_prm_state_update of local bases into an atlas of half floats, [height][width][4]: the nearest, at most 65504.
lw_result updateHalfs(lw_prm_state& state, const float* cluster_rgb, const lw_prm_options& options, uint16_t* atlas_rgba, lw_prm_changes& changes);

}  // namespace lightwell::runtime
