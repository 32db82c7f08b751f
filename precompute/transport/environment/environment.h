// Light from an environment map, as data: what the bake makes and the container holds.
//
// After Barsi, Szirmay-Kalos, Szécsi, "Image-Based Illumination on the GPU": the sphere of directions is cut into cells, each a directional
// light with one visibility test. Two things go beyond the paper. A cell carries the spread of the power inside it, from which the average
// reflectivity follows. And a small map of the whole sky answers everything that is not occluded; cells then only carry what is hidden:
//   reflected(x) = sky(x) + Σ_sun visible · cell − Σ_(other cells) hidden · cell.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// All arrays have one element per cell. The first `sun_count` cells are suns: bright spots with edges of their own; the others are the
/// spherical Voronoi cells of the rest, by falling luminance of their flux. 48 bytes a cell.
struct EnvironmentCells {
  uint32_t sun_count = 0;
  std::vector<Vec3> direction;          // unit, toward the light: the centroid of its power
  std::vector<Rgb> flux_rgb;            // Σ L dω over the cell: the irradiance on a plane that faces it, were it small
  std::vector<float> solid_angle_sr;    // of the cell; all together 4π
  std::vector<float> cos_radius;        // of the cap with that solid angle: 1 − solid_angle_sr / 2π
  std::vector<float> spread;            // 1 − mean cosine between the power and `direction`, [0, 1]
  std::vector<std::array<float, 3>> covariance;  // xx, xy, yy of the power, projected on the tangents of orthonormalBasis(direction)
  uint32_t count() const { return uint32_t(direction.size()); }
};

/// The sky without its suns, as the point masses of interpolation nodes (see sky_nodes.h): for every smooth f,
/// ∫ L f dω ≈ Σ_node mass · f(direction of the node), exact where f is a cubic in each cell of the grid.
struct EnvironmentSky {
  uint32_t face_cells = 0;        // m: a face of the cube has (m + 1)² nodes
  float scale = 1;                // mass_rgb = scale · (4π / 6m²) · value; a power of two
  std::vector<uint16_t> value;    // half floats [6][m + 1][m + 1][3]; slightly negative beside bright spots
  Rgb flux_rgb{0, 0, 0};          // ∫ L dω, exact
  std::array<Rgb, 9> radiance_sh{};  // real spherical harmonics to order 2: c_lm = ∫ L Y_lm dω; order in sky_harmonics.h
};

struct Environment {
  EnvironmentCells cells;
  EnvironmentSky sky;
};

}  // namespace lightwell::transport
