#include "precompute/transport/environment/spherical_voronoi.h"

#include <algorithm>

#include "precompute/core/parallel.h"

namespace lightwell::transport {
namespace {

constexpr int kTileTexels = 8;
constexpr float kAngleSlack = 1e-5f;  // rounding of the angles

/// Angle between unit vectors, accurate when it is small.
float angleBetween(const Vec3& a, const Vec3& b) { return 2 * std::asin(std::min(1.0f, 0.5f * (a - b).length())); }

}  // namespace

SphericalVoronoi::SphericalVoronoi(const SkyGrid& grid) : grid_(grid) {
  for (int y = 0; y < grid.height; y += kTileTexels)
    for (int x = 0; x < grid.width; x += kTileTexels) {
      Tile tile{x, y, std::min(x + kTileTexels, grid.width), std::min(y + kTileTexels, grid.height), Vec3(0), 0};
      const auto direction = [&](int column, int row) -> const Vec3& {
        return grid.direction[size_t(row) * size_t(grid.width) + size_t(column)];
      };
      for (int row = tile.y0; row < tile.y1; ++row)
        for (int column = tile.x0; column < tile.x1; ++column) tile.center += direction(column, row);
      tile.center = tile.center.length() > 1e-6f ? tile.center.normalized() : direction(x, y);
      for (int row = tile.y0; row < tile.y1; ++row)
        for (int column = tile.x0; column < tile.x1; ++column)
          tile.radius_rad = std::max(tile.radius_rad, angleBetween(tile.center, direction(column, row)));
      tiles_.push_back(tile);
    }
}

std::vector<uint32_t> SphericalVoronoi::assign(std::span<const Vec3> seed, int threads) const {
  std::vector<uint32_t> label(grid_.size());
  parallelFor(tiles_.size(), 64, threads, nullptr, [&](size_t begin, size_t end) {
    std::vector<float> chord2(seed.size());
    std::vector<uint32_t> candidate;
    for (size_t t = begin; t < end; ++t) {
      const Tile& tile = tiles_[t];
      float nearest2 = 4;
      for (size_t i = 0; i < seed.size(); ++i) {
        chord2[i] = (tile.center - seed[i]).length2();
        nearest2 = std::min(nearest2, chord2[i]);
      }
      // A texel is at most nearest + radius from some seed, and at least angle − radius from this one.
      const float reach = 2 * std::asin(std::min(1.0f, 0.5f * std::sqrt(nearest2))) + 2 * tile.radius_rad + kAngleSlack;
      const float reach2 = reach < kPi ? std::pow(2 * std::sin(0.5f * reach), 2.0f) : 5.0f;
      candidate.clear();
      for (size_t i = 0; i < seed.size(); ++i)
        if (chord2[i] <= reach2) candidate.push_back(uint32_t(i));
      for (int y = tile.y0; y < tile.y1; ++y)
        for (int x = tile.x0; x < tile.x1; ++x) {
          const size_t texel = size_t(y) * size_t(grid_.width) + size_t(x);
          const Vec3& d = grid_.direction[texel];
          float best = std::numeric_limits<float>::infinity();
          for (uint32_t i : candidate)
            if (const float distance2 = (d - seed[i]).length2(); distance2 < best) best = distance2, label[texel] = i;
        }
    }
  });
  return label;
}

}  // namespace lightwell::transport
