// The transport of one block of texels before any compression: what each texel gathers from each cluster around the block.
#pragma once
#include "precompute/transport/prm/multi_bounce.h"

namespace lightwell::transport {

/// Dense over the clusters that some texel of the block sees.
struct BlockTransport {
  std::vector<uint32_t> cluster;                // ascending
  std::array<Eigen::MatrixXf, 3> from_cluster;  // per channel [texel][cluster]: one gathered bounce
};

/// Gathers `rays` rays at each of the texels' fronts. `cluster_count`: of all.
BlockTransport gatherBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, uint32_t rays, uint32_t cluster_count);

}  // namespace lightwell::transport
