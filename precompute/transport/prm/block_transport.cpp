#include "precompute/transport/prm/block_transport.h"

#include <algorithm>

namespace lightwell::transport {

BlockTransport gatherBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, uint32_t rays) {
  std::vector<GatherRow> rows;
  rows.reserve(slots.size());
  BlockTransport block;
  for (const uint32_t slot : slots) {
    rows.push_back(gatherer.side(slot, rays));
    block.cluster.insert(block.cluster.end(), rows.back().cluster.begin(), rows.back().cluster.end());
  }
  std::sort(block.cluster.begin(), block.cluster.end());
  block.cluster.erase(std::unique(block.cluster.begin(), block.cluster.end()), block.cluster.end());
  for (auto& matrix : block.from_cluster) matrix.setZero(slots.size(), block.cluster.size());
  for (size_t t = 0; t < rows.size(); ++t) {
    size_t column = 0;
    for (size_t i = 0; i < rows[t].cluster.size(); ++i) {
      while (block.cluster[column] != rows[t].cluster[i]) ++column;
      for (int channel = 0; channel < 3; ++channel) block.from_cluster[channel](t, column) = rows[t].transfer_rgb[i][channel];
    }
  }
  return block;
}

}  // namespace lightwell::transport
