// The transport of one block of texels before any compression: what each texel gathers from each cluster around the block.
#pragma once
#include "precompute/transport/prm/multi_bounce.h"

namespace lightwell::transport {

/// Dense over the clusters that some texel of the block sees.
struct BlockTransport {
  std::vector<uint32_t> cluster;                // ascending
  std::vector<uint32_t> group;                  // groups of those clusters, ascending
  std::vector<uint32_t> group_index;            // per cluster: its place in `group`
  std::array<Eigen::MatrixXf, 3> from_cluster;  // per channel [texel][cluster]: one gathered bounce
  std::array<Eigen::MatrixXf, 3> from_group;    // the same summed over each group's clusters
};

/// Gathers `rays` rays at each of the texels' fronts.
BlockTransport gatherBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, const EntryClusters& clusters, uint32_t rays);

/// Rows of a matrix over all groups, cut down to those in `group`.
Eigen::MatrixXf groupRows(const std::vector<uint32_t>& group, const Eigen::Ref<const ChannelMatrices::value_type>& matrix);

}  // namespace lightwell::transport
