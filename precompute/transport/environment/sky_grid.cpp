#include "precompute/transport/environment/sky_grid.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

constexpr int divideUp(int a, int b) { return (a + b - 1) / b; }

/// Blocks of whole texels over a fine grid; the last ones of a side may be smaller.
struct Blocks {
  int fine_width, fine_height, width_texels, height_texels, width, height;

  Blocks(int fine_width, int fine_height, int max_width)
      : fine_width(fine_width), fine_height(fine_height), width_texels(divideUp(fine_width, max_width)),
        height_texels(divideUp(fine_height, std::max(1, max_width / 2))), width(divideUp(fine_width, width_texels)),
        height(divideUp(fine_height, height_texels)) {}
  /// Middle of block `i` along an axis, in texels of the fine grid.
  static double middle(int i, int texels, int fine) { return 0.5 * (double(i) * texels + std::min(fine, (i + 1) * texels)); }
  double middleColumn(int x) const { return middle(x, width_texels, fine_width); }
  double middleRow(int y) const { return middle(y, height_texels, fine_height); }
};

SkyGrid emptyGrid(int width, int height) {
  SkyGrid grid;
  grid.width = width, grid.height = height;
  const size_t count = size_t(width) * size_t(height);
  grid.direction.resize(count);
  grid.flux_rgb.resize(count);
  grid.solid_angle_sr.resize(count);
  return grid;
}

}  // namespace

SkyGrid makeSkyGrid(EnvironmentMap& map, int max_width, Diagnostics& diagnostics, const CancelFlag* cancel) {
  const Blocks blocks(map.width(), map.height(), max_width);
  SkyGrid grid = emptyGrid(blocks.width, blocks.height);
  grid.frame = {map.direction(0, 0), map.direction(0.5 * map.width(), 0.5 * map.height()),
                map.direction(0.75 * map.width(), 0.5 * map.height())};
  constexpr double pi = std::numbers::pi;
  std::vector<Vec3d> on_horizon(size_t(blocks.width));
  for (int x = 0; x < blocks.width; ++x)
    on_horizon[size_t(x)] = grid.directionAt(0.5 * pi, (blocks.middleColumn(x) / map.width() - 0.5) * 2 * pi);
  for (int y = 0; y < blocks.height; ++y) {
    const double theta = blocks.middleRow(y) / map.height() * pi;
    const Vec3d up = grid.frame[0] * std::cos(theta);
    for (int x = 0; x < blocks.width; ++x)
      grid.direction[size_t(y) * size_t(blocks.width) + size_t(x)] = Vec3(up + on_horizon[size_t(x)] * std::sin(theta));
  }
  map.visitRows(diagnostics, cancel, [&](int row, std::span<const Rgb> radiance_rgb) {
    const double texel_solid_angle = map.texelSolidAngle(row);
    const size_t first = size_t(row / blocks.height_texels) * size_t(blocks.width);
    for (int x = 0, fine = 0; x < blocks.width; ++x) {
      const size_t i = first + size_t(x);
      const int end = std::min(fine + blocks.width_texels, map.width());
      grid.solid_angle_sr[i] += texel_solid_angle * (end - fine);
      for (; fine < end; ++fine)
        for (int c = 0; c < 3; ++c) grid.flux_rgb[i][size_t(c)] += texel_solid_angle * double(radiance_rgb[size_t(fine)][c]);
    }
  });
  return grid;
}

SkyGrid reduceSkyGrid(const SkyGrid& fine, int max_width, const std::vector<uint8_t>& excluded) {
  const Blocks blocks(fine.width, fine.height, max_width);
  SkyGrid grid = emptyGrid(blocks.width, blocks.height);
  grid.frame = fine.frame;
  constexpr double pi = std::numbers::pi;
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const size_t to = size_t(y) * size_t(grid.width) + size_t(x);
      grid.direction[to] =
          Vec3(grid.directionAt(blocks.middleRow(y) / fine.height * pi, (blocks.middleColumn(x) / fine.width - 0.5) * 2 * pi));
      for (int fine_y = y * blocks.height_texels; fine_y < std::min(fine.height, (y + 1) * blocks.height_texels); ++fine_y)
        for (int fine_x = x * blocks.width_texels; fine_x < std::min(fine.width, (x + 1) * blocks.width_texels); ++fine_x) {
          const size_t from = size_t(fine_y) * size_t(fine.width) + size_t(fine_x);
          if (!excluded.empty() && excluded[from]) continue;
          for (size_t c = 0; c < 3; ++c) grid.flux_rgb[to][c] += fine.flux_rgb[from][c];
          grid.solid_angle_sr[to] += fine.solid_angle_sr[from];
        }
    }
  return grid;
}

std::vector<uint32_t> expandLabels(const SkyGrid& fine, int max_width, const std::vector<uint32_t>& block_label) {
  const Blocks blocks(fine.width, fine.height, max_width);
  std::vector<uint32_t> label(fine.size());
  for (int y = 0, i = 0; y < fine.height; ++y)
    for (int x = 0; x < blocks.width; ++x) {
      const uint32_t value = block_label[size_t(y / blocks.height_texels) * size_t(blocks.width) + size_t(x)];
      for (const int end = i + std::min(blocks.width_texels, fine.width - x * blocks.width_texels); i < end; ++i) label[size_t(i)] = value;
    }
  return label;
}

}  // namespace lightwell::transport
