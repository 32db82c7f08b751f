// The sky alone: answers of its cells against quadrature over the map, nothing in the way.
#pragma once
#include "cli/report/result.h"
#include "precompute/bake/context.h"

namespace lightwell::report {

/// Numbers of cells that are measured, ascending.
inline constexpr uint32_t kSkyCells[] = {8, 16, 32, 64, 128, 256, 512};
/// For irradiance and for Phong lobes of shininess 100, over 500 directions. Throws InputError and Cancelled.
std::vector<SkyAnswer> measureSky(const bake::SceneSource& source, const plan::Settings& settings, int threads, const CancelFlag& cancel);

}  // namespace lightwell::report
