// Which seed is nearest to each texel of a latitude-longitude grid: spherical Voronoi cells, exact on the texels, poles and seam included.
//
// Texels are grouped in tiles; a tile keeps the few seeds that can win in it (by the triangle inequality on the sphere), so the cost per
// texel hardly grows with the number of seeds.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/transport/environment/sky_grid.h"

namespace lightwell::transport {

class SphericalVoronoi {
 public:
  /// `grid` must outlive this.
  explicit SphericalVoronoi(const SkyGrid& grid);

  /// The winner (ties: the lower index) of each texel. `seed` are unit vectors, at least one.
  std::vector<uint32_t> assign(std::span<const Vec3> seed, int threads) const;

 private:
  struct Tile {
    int x0, y0, x1, y1;  // texels [x0, x1) × [y0, y1)
    Vec3 center;
    float radius_rad;    // largest angle from `center` to a texel's direction
  };
  const SkyGrid& grid_;
  std::vector<Tile> tiles_;
};

}  // namespace lightwell::transport
