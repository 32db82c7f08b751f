// Evaluating the section "lightmap" with the runtime: on the CPU, or on OpenGL without a window.
#pragma once
#include <vector>

#include "cli/runtime_handles.h"

namespace lightwell::cli {

/// Irradiance, [height * width][4]; `light`: LW_LIGHTMAP_… bits to add. Each texel's own mean, not what it shows in a game; A = 1 where there is a value.
std::vector<float> evaluateLightmapOnCpu(const RuntimeContainer& container, uint32_t light);
/// The same from the texture of an OpenGL 3.3 context without a surface. Throws UsageError when this machine gives none.
std::vector<float> evaluateLightmapOnGl(const RuntimeContainer& container, uint32_t light);

}  // namespace lightwell::cli
