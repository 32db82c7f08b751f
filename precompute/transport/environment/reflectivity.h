// The average of a material's lobe over a cell's light: what one directional light has to be multiplied with.
#pragma once
#include <cstdint>

#include "precompute/transport/environment/environment.h"

namespace lightwell::transport {

/// Ways to average cos^n ψ over a cell.
enum class Reflectivity : uint8_t {
  single,  // one sample in the cell's direction
  paper,   // Barsi et al., section 2.3: even radiance over a cap, exact at its centre, blended into the single sample at its rim
  vmf,     // the power as a von Mises–Fisher lobe times exp(n (cos ψ − 1)), a product with a closed form; wrong for n below about 10
  spread,  // the power as a Gaussian with the cell's own covariance, folded with the lobe (default)
};

/// One cell, as the formulas want it.
struct CellShape {
  Vec3 direction;
  float solid_angle_sr, spread;
  std::array<float, 3> covariance;
};
CellShape cellShape(const EnvironmentCells& cells, uint32_t cell);

/// max(0, cos ψ)^n for unit vectors; exact to float accuracy for n from 0 to 1e5 and any angle, by way of their distance.
float cosinePower(const Vec3& a, const Vec3& b, float n);

/// Mean of max(0, cos ψ)^n over the cell's light, ψ measured from the unit vector `mirror`; n in [1, 1e5]; in [0, 1], finite for every
/// cell.
float averageCosinePower(Reflectivity model, const CellShape& cell, const Vec3& mirror, float n);
/// Mean of max(0, cos θ) over the cell's light. Exact for `spread` where the cell lies on one side of the horizon; across it the light
/// is taken as a Gaussian in height. The other models take the single sample, as the paper does.
float averageCosine(Reflectivity model, const CellShape& cell, const Vec3& normal);

/// The paper's average at the centre of a cap: (1 − cos^(n+1) r) / ((n + 1)(1 − cos r)), without cancellation; `solid_angle_sr` in (0, 4π].
/// Beyond r = π/2 the lobe is zero.
float capAverageAtCenter(float solid_angle_sr, float n);

}  // namespace lightwell::transport
