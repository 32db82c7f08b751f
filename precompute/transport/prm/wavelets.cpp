#include "precompute/transport/prm/wavelets.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace lightwell::transport {

std::vector<WaveletTree::Children> WaveletTree::children(uint32_t clusters) const {
  const uint32_t nodes = uint32_t(first_leaves.size());
  if (first_share.size() != nodes || (clusters ? nodes != clusters - 1 : nodes != 0)) throw std::runtime_error("the tree of wavelets is damaged");
  struct Range {
    uint32_t first_leaf, leaves;
  };
  std::vector<Range> range(nodes);
  std::vector<Children> result(nodes);
  if (nodes) range[0] = {0, clusters};
  for (uint32_t n = 0; n < nodes; ++n) {
    const auto [first_leaf, leaves] = range[n];
    const uint32_t first = first_leaves[n];
    if (first == 0 || first >= leaves) throw std::runtime_error("the tree of wavelets is damaged");
    const auto child = [&](uint32_t node, Range under) {
      if (under.leaves == 1) return under.first_leaf | kLeaf;
      range[node] = under;
      return node;
    };
    result[n].first = child(n + 1, {first_leaf, first});  // the first child's inner nodes follow, one fewer than its leaves
    result[n].second = child(n + first, {first_leaf + first, leaves - first});
  }
  return result;
}

std::vector<float> toWavelets(const WaveletTree& tree, std::span<const WaveletTree::Children> children, uint32_t width, std::span<const float> cluster_value) {
  if (cluster_value.empty()) return {};
  const uint32_t clusters = uint32_t(children.size()) + 1;
  std::vector<float> value(size_t(waveletCount(clusters)) * width);
  std::copy(cluster_value.begin(), cluster_value.end(), value.begin());
  for (uint32_t n = clusters - 1; n-- > 0;) {
    const float share = tree.shareOf(n);
    const float *first = &value[size_t(meanIndex(clusters, children[n].first)) * width], *second = &value[size_t(meanIndex(clusters, children[n].second)) * width];
    float *mean = &value[size_t(meanIndex(clusters, n)) * width], *difference = &value[size_t(differenceIndex(clusters, n)) * width];
    for (uint32_t k = 0; k < width; ++k) {
      mean[k] = share * first[k] + (1 - share) * second[k];
      difference[k] = first[k] - second[k];
    }
  }
  return value;
}

void responseToWavelets(const WaveletTree& tree, std::span<const WaveletTree::Children> children, uint32_t width, std::span<float> response) {
  const uint32_t clusters = uint32_t(children.size()) + 1;
  const auto at = [&](uint32_t child) { return &response[size_t(meanIndex(clusters, child)) * width]; };
  // The mean of a subtree is made of its children's, by their shares: first all responses go down to the clusters, then they are summed up again.
  for (uint32_t n = 0; n + 1 < clusters; ++n) {
    const float share = tree.shareOf(n);
    float *mean = at(n), *first = at(children[n].first), *second = at(children[n].second);
    for (uint32_t k = 0; k < width; ++k) {
      first[k] += share * mean[k];
      second[k] += (1 - share) * mean[k];
    }
  }
  for (uint32_t n = clusters - 1; n-- > 0;) {
    const float share = tree.shareOf(n);
    const float *first = at(children[n].first), *second = at(children[n].second);
    float *mean = at(n), *difference = &response[size_t(differenceIndex(clusters, n)) * width];
    for (uint32_t k = 0; k < width; ++k) {
      mean[k] = first[k] + second[k];
      difference[k] = (1 - share) * first[k] - share * second[k];
    }
  }
}

float waveletUnit(uint8_t code) { return std::exp2((float(code) - 160.0f) / 8.0f); }

uint8_t waveletUnitCode(float size) {
  if (!(size > 0)) return 0;
  return uint8_t(std::clamp(std::ceil(std::log2(size) * 8.0f + 160.0f), 0.0f, 255.0f));
}

}  // namespace lightwell::transport
