#include "precompute/transport/prm/block_transport.h"

#include <algorithm>

namespace lightwell::transport {

BlockTransport gatherBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, const EntryClusters& clusters, uint32_t rays) {
  std::vector<GatherRow> rows;
  rows.reserve(slots.size());
  BlockTransport block;
  for (const uint32_t slot : slots) {
    rows.push_back(gatherer.side(slot, rays));
    block.cluster.insert(block.cluster.end(), rows.back().cluster.begin(), rows.back().cluster.end());
  }
  std::sort(block.cluster.begin(), block.cluster.end());
  block.cluster.erase(std::unique(block.cluster.begin(), block.cluster.end()), block.cluster.end());
  // Clusters are numbered group by group, so the groups ascend as well.
  for (const uint32_t cluster : block.cluster) {
    const uint32_t group = clusters.group_of_cluster[cluster];
    if (block.group.empty() || block.group.back() != group) block.group.push_back(group);
    block.group_index.push_back(uint32_t(block.group.size()) - 1);
  }
  for (int channel = 0; channel < 3; ++channel) {
    block.from_cluster[channel].setZero(slots.size(), block.cluster.size());
    block.from_group[channel].setZero(slots.size(), block.group.size());
  }
  for (size_t t = 0; t < rows.size(); ++t) {
    size_t column = 0;
    for (size_t i = 0; i < rows[t].cluster.size(); ++i) {
      while (block.cluster[column] != rows[t].cluster[i]) ++column;
      for (int channel = 0; channel < 3; ++channel) {
        const float transfer = rows[t].transfer_rgb[i][channel];
        block.from_cluster[channel](t, column) = transfer;
        block.from_group[channel](t, block.group_index[column]) += transfer;
      }
    }
  }
  return block;
}

Eigen::MatrixXf groupRows(const std::vector<uint32_t>& group, const Eigen::Ref<const ChannelMatrices::value_type>& matrix) {
  Eigen::MatrixXf rows(group.size(), matrix.cols());
  for (size_t i = 0; i < group.size(); ++i) rows.row(i) = matrix.row(group[i]);
  return rows;
}

}  // namespace lightwell::transport
