// All further bounces: what fine clusters receive from direct irradiance on groups, after one reflection and more.
//
// Light that was reflected once more is smooth at its source, so sources are groups; receivers are fine clusters, because the last bounce before a texel
// may lie just behind a wall or a corner that its group reaches around. With F the transport from groups to fine clusters, R its mean over the
// clusters of each group (groups to groups) and S = (I − R)⁻¹ R:
//   indirect(cluster) = Σ_group [F (I + S)](cluster, group) · direct(group)
#pragma once
#include <Eigen/Core>
#include <array>

#include "precompute/transport/prm/gather.h"
#include "precompute/transport/prm/product.h"

namespace lightwell::transport {

/// One dense matrix per colour channel. Row-major: a row is what one group receives.
using ChannelMatrices = std::array<RowMajorMatrix, 3>;

/// F: one sparse row per fine cluster, groups ascending.
struct GroupRows {
  std::vector<uint32_t> first = {0};  // rows + 1
  std::vector<uint32_t> group;
  std::vector<Rgb> transfer_rgb;

  /// Appends a row gathered from fine clusters, summed over their groups.
  void append(const EntryClusters& clusters, const GatherRow& gathered);
  /// Appends another's rows.
  void append(const GroupRows& other);
};

struct MultiBounce {
  GroupRows rows;            // F
  ChannelMatrices solution;  // S

  /// Indirect irradiance on every fine cluster, [cluster][light], for direct irradiance on groups, [group][light].
  Eigen::MatrixXf received(int channel, const Eigen::MatrixXf& group_direct) const;
  /// The response to unit direct irradiance on each group, [any][group], for a response to irradiance on the listed fine clusters, [any][cluster]: of light that is reflected once on
  /// its way to them, and, from that, of all further bounces too. Rows of many responses may be put together for the second, which is dear.
  std::array<Eigen::MatrixXf, 3> onceReflected(const std::vector<uint32_t>& cluster, const std::array<Eigen::MatrixXf, 3>& cluster_response) const;
  RowMajorMatrix allBounces(int channel, const Eigen::MatrixXf& once_reflected) const;
};

/// Joins F with the S that follows from it. Solved by LU, in double precision where albedo is near 1 (spectral radius near 1). Throws
/// std::runtime_error when a system is singular to working precision (only possible when albedo reaches 1, which the importer prevents).
MultiBounce solveMultiBounce(const EntryClusters& clusters, GroupRows rows);

}  // namespace lightwell::transport
