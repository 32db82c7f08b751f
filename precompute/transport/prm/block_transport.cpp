#include "precompute/transport/prm/block_transport.h"

#include <algorithm>

namespace lightwell::transport {

BlockTransport gatherBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, uint32_t rays, uint32_t cluster_count) {
  std::vector<std::vector<Gatherer::Hit>> hits;
  std::vector<uint32_t> column(cluster_count, kNone);
  BlockTransport block;
  const HemisphereBundle bundle = gatherer.bundle(rays, slots.front());
  for (const uint32_t slot : slots)
    for (const auto& hit : hits.emplace_back(gatherer.hits(slot, bundle)))
      if (column[hit.cluster] == kNone) {
        column[hit.cluster] = 0;
        block.cluster.push_back(hit.cluster);
      }
  std::sort(block.cluster.begin(), block.cluster.end());
  for (uint32_t i = 0; i < block.cluster.size(); ++i) column[block.cluster[i]] = i;
  for (auto& matrix : block.from_cluster) matrix.setZero(Eigen::Index(slots.size()), Eigen::Index(block.cluster.size()));
  const float share = 1.0f / float(rays);
  for (size_t t = 0; t < hits.size(); ++t)
    for (const auto& [cluster, albedo_rgb] : hits[t])
      for (int channel = 0; channel < 3; ++channel) block.from_cluster[channel](Eigen::Index(t), column[cluster]) += albedo_rgb[channel] * share;
  return block;
}

}  // namespace lightwell::transport
