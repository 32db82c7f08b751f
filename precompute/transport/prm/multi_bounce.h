// All further bounces at the scale of groups: from direct irradiance on groups to their indirect irradiance.
#pragma once
#include <Eigen/Core>
#include <array>

#include "precompute/transport/prm/gather.h"

namespace lightwell::transport {

/// One dense matrix per colour channel. Row-major: a row is what one group receives.
using ChannelMatrices = std::array<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>, 3>;

/// Folds a gathered row over clusters into one over groups (added to `row` of `matrices`).
void addGroupRow(const EntryClusters& clusters, const GatherRow& gathered, uint32_t row, ChannelMatrices& matrices);

/// S = (I − R)⁻¹ R per channel, R[i][j] the irradiance that group i receives from unit irradiance on group j: the Neumann series R + R² + …
/// without cutting it. Solved in double by LU, so that albedo near 1 (spectral radius near 1) stays accurate. Throws std::runtime_error when
/// a system is singular to working precision (only possible when albedo reaches 1, which the importer prevents).
ChannelMatrices solveMultiBounce(const ChannelMatrices& one_bounce);

}  // namespace lightwell::transport
