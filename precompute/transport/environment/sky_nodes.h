// A small map that integrates smooth functions over a detailed sky almost exactly.
//
// Six faces of a cube, each with (m + 1)² nodes at equal angles (tan of equal steps, corners included). A texel of flux F in direction d is
// spread over the 4 × 4 nodes around it with the weights of cubic Lagrange interpolation at d. Then Σ_node mass · f(node) is the integral
// of L times the cubic interpolant of f: the error is that of interpolating f, h⁴ f'''' (h = π / 2m), whatever the detail in L. This is the
// transpose of interpolation, "anterpolation" in the fast multipole literature (Brandt and Lubrecht 1990). Stencils never leave a face.
#pragma once
#include <array>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/core/math.h"

namespace lightwell::transport {

/// Face f: axis ±x, ±y, ±z for f = 0…5; its first tangent is the next axis in cyclic order, its second the one after; node
/// [f][j][i] lies at first tangent tan((2i/m − 1) π/4), second tangent tan((2j/m − 1) π/4).
struct SkyNodes {
  uint32_t face_cells = 0;                         // m ≥ 4
  std::vector<std::array<double, 3>> mass_rgb;     // [6][m + 1][m + 1]

  explicit SkyNodes(uint32_t face_cells) : face_cells(face_cells), mass_rgb(nodeCount(face_cells)) {}
  static size_t nodeCount(uint32_t face_cells) { return 6 * size_t(face_cells + 1) * size_t(face_cells + 1); }
  /// Unit direction of node `index`.
  static Vec3d direction(uint32_t face_cells, size_t index);

  /// Spreads flux at a unit direction.
  void splat(const Vec3d& direction, const std::array<double, 3>& flux_rgb);
  void add(const SkyNodes& other);
  /// The same masses on half as many cells; face_cells must be even and at least 8.
  SkyNodes coarser() const;
};

/// The masses that a sky of radiance 1 has on the nodes, [(m + 1)²] of one face (all faces are alike). They add to 4π / 6.
std::vector<double> uniformNodeMass(uint32_t face_cells);

}  // namespace lightwell::transport
