// Finds the sun: bright spots many stops above all that surrounds them, which one cell of a sky could not stand for.
#pragma once
#include <vector>

#include "precompute/transport/environment/sky_grid.h"

namespace lightwell::transport {

struct SunSettings {
  int max_suns = 16;
  float stops_above_mean = 6;          // log2 of the peak over the mean radiance of the rest
  float stops_above_surroundings = 4;  // log2 of the peak over the mean radiance of a rim three texels off the spot
  float max_radius_rad = 0.0209f;      // 1.2°: wider spots are resolved by cells and sky
  float min_share = 1.0f / 128;        // of the luminous flux of all
};

/// Per sun the indices of its texels, ascending; suns by falling luminous flux. A spot's texels are connected and at least 1/8 as bright as
/// its brightest.
std::vector<std::vector<uint32_t>> findSuns(const SkyGrid& grid, const SunSettings& settings);

}  // namespace lightwell::transport
