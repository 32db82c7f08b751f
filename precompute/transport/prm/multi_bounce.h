// All further bounces: what fine clusters receive from direct irradiance on fine clusters, after one reflection and more.
//
// The first reflection goes from fine clusters to fine clusters: what lies just behind a wall or an edge is dark however bright the group around it is. Light that was
// reflected twice is smooth at its source, so from there on sources are groups. With F the transport between fine clusters, F' the same from groups (its
// columns added up), R the mean of F' over the clusters of each group (groups to groups), P the mean over groups and S = (I − R)⁻¹ R:
//   indirect = (F + F' S P) direct
#pragma once
#include <Eigen/Core>
#include <array>

#include "precompute/transport/prm/gather.h"
#include "precompute/transport/prm/product.h"

namespace lightwell::transport {

/// One dense matrix per colour channel. Row-major: a row is what one group receives.
using ChannelMatrices = std::array<RowMajorMatrix, 3>;

/// F: one sparse row per fine cluster, clusters ascending.
struct ClusterRows {
  std::vector<uint32_t> first = {0};  // rows + 1
  std::vector<uint32_t> cluster;
  std::vector<Rgb> transfer_rgb;

  void append(const GatherRow& row);
  /// Appends another's rows.
  void append(const ClusterRows& other);
};

struct MultiBounce {
  ClusterRows rows;          // F
  ChannelMatrices solution;  // S

  /// Indirect irradiance on every fine cluster, [cluster][light], for direct irradiance on them.
  RowMajorMatrix received(int channel, const EntryClusters& clusters, const RowMajorMatrix& direct) const;
  /// The response to unit direct irradiance that is reflected once on its way to the listed fine clusters, [any][place], for a response to irradiance on these, [any][cluster].
  /// Places are parts of groups; `place_of_cluster`: of every fine cluster.
  std::array<Eigen::MatrixXf, 3> onceReflected(const std::vector<uint32_t>& cluster, const std::array<Eigen::MatrixXf, 3>& cluster_response,
                                               const std::vector<uint32_t>& place_of_cluster, uint32_t places) const;
  /// The response to unit direct irradiance on each group that is reflected more than once, [any][group], for that which is reflected once. Rows of many responses may be put
  /// together: it is dear.
  RowMajorMatrix furtherReflected(int channel, const Eigen::MatrixXf& once_reflected) const;
};

/// Joins F with the S that follows from it. Solved by LU, in double precision where albedo is near 1 (spectral radius near 1). Throws
/// std::runtime_error when a system is singular to working precision (only possible when albedo reaches 1, which the importer prevents).
MultiBounce solveMultiBounce(const EntryClusters& clusters, ClusterRows rows);

}  // namespace lightwell::transport
