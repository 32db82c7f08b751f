// The working resolution of a decomposition: sums over blocks of the map's texels.
#pragma once
#include <array>
#include <vector>

#include "precompute/transport/environment/environment_map.h"

namespace lightwell::transport {

/// A latitude-longitude grid. Every array has width * height elements, row 0 first. Blocks are whole texels, so sums over the grid are
/// sums over the map.
struct SkyGrid {
  int width = 0, height = 0;
  std::vector<Vec3> direction;                    // world, of the block's middle
  std::vector<std::array<double, 3>> flux_rgb;    // Σ L dω
  std::vector<double> solid_angle_sr;             // Σ dω; all together 4π

  std::array<Vec3d, 3> frame{};                   // world: the zenith of the map, its middle column's horizon, a quarter turn on

  size_t size() const { return direction.size(); }
  /// World direction at `theta` from the zenith of the map and `phi` from its middle column.
  Vec3d directionAt(double theta, double phi) const {
    return frame[0] * std::cos(theta) + (frame[1] * std::cos(phi) + frame[2] * std::sin(phi)) * std::sin(theta);
  }
};

using lightwell::luminance;
inline double luminance(const std::array<double, 3>& c) { return 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2]; }

/// Reads a map once. The grid is the map's own, or coarser by whole numbers so that it has at most `max_width` columns and half as many
/// rows.
SkyGrid makeSkyGrid(EnvironmentMap& map, int max_width, Diagnostics& diagnostics, const CancelFlag* cancel);
/// Sums of blocks, at most `max_width` columns and half as many rows, without the texels marked in `excluded` (empty, or one byte per
/// texel).
SkyGrid reduceSkyGrid(const SkyGrid& grid, int max_width, const std::vector<uint8_t>& excluded = {});
/// Gives each texel of `grid` the label of its block in reduceSkyGrid(grid, max_width).
std::vector<uint32_t> expandLabels(const SkyGrid& grid, int max_width, const std::vector<uint32_t>& block_label);

}  // namespace lightwell::transport
