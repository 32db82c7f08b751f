#include "precompute/transport/prm/response_tree.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

// Clusters that may be one leaf where no ray of the block met any of them: their light is reflected once more before it reaches the block, but perhaps just behind an edge.
constexpr uint32_t kMostUnmet = 4;

}  // namespace

WaveletIndex::WaveletIndex(const EntryClusters& clusters)
    : root(clusters.cluster_count == 1 ? WaveletTree::kLeaf : 0), children(clusters.tree.children(clusters.cluster_count)), leaves(children.size()) {
  if (!leaves.empty()) leaves[0] = {0, clusters.cluster_count};
  for (uint32_t n = 0; n < children.size(); ++n) {
    const auto [first, end] = leaves[n];
    const uint32_t middle = first + clusters.tree.first_leaves[n];
    if (!(children[n].first & WaveletTree::kLeaf)) leaves[children[n].first] = {first, middle};
    if (!(children[n].second & WaveletTree::kLeaf)) leaves[children[n].second] = {middle, end};
  }
}

ResponseTree::ResponseTree(const EntryClusters& clusters, const WaveletIndex& all, const std::vector<uint32_t>& met) : leaf_of_cluster(clusters.cluster_count), group_mean(clusters.group_count) {
  if (clusters.cluster_count == 0) return;
  struct Visit {
    uint32_t child, parent;  // of the whole tree; of this one
    bool is_first;
  };
  std::vector<uint32_t> leaf, node;        // the whole tree's children that are leaves and inner nodes of this one
  std::vector<uint32_t> node_of_group(clusters.group_count);
  std::vector<Visit> open = {{all.root, 0, false}};
  auto next_met = met.begin();
  while (!open.empty()) {
    const auto [child, parent, is_first] = open.back();
    open.pop_back();
    const auto [first, end] = all.leavesOf(child);
    const uint32_t group = clusters.group_of_cluster[first];
    const bool any_met = next_met != met.end() && *next_met < end;  // clusters are visited in their order
    const bool is_leaf = child & WaveletTree::kLeaf || (!any_met && end - first <= kMostUnmet && clusters.group_of_cluster[end - 1] == group);
    const uint32_t place = is_leaf ? uint32_t(leaf.size()) | WaveletTree::kLeaf : uint32_t(node.size());
    if (clusters.group_first_cluster[group] == first && clusters.group_first_cluster[group + 1] == end) node_of_group[group] = place;
    if (!node.empty()) (is_first ? children[parent].first : children[parent].second) = place;
    if (is_leaf) {
      if (any_met) ++next_met;
      std::fill(leaf_of_cluster.begin() + first, leaf_of_cluster.begin() + end, uint32_t(leaf.size()));
      leaf.push_back(child);
      group_of_leaf.push_back(group);
      continue;
    }
    node.push_back(child);
    children.emplace_back();
    shares.first_share.push_back(clusters.tree.first_share[child]);
    open.push_back({all.children[child].second, place, false});
    open.push_back({all.children[child].first, place, true});
  }
  leaves = uint32_t(leaf.size());
  for (uint32_t group = 0; group < clusters.group_count; ++group) group_mean[group] = meanIndex(leaves, node_of_group[group]);
  for (const uint32_t child : leaf) wavelet.push_back(meanIndex(clusters.cluster_count, child));
  for (const uint32_t child : node) wavelet.push_back(meanIndex(clusters.cluster_count, child));
  for (const uint32_t child : node) wavelet.push_back(differenceIndex(clusters.cluster_count, child));
}

}  // namespace lightwell::transport
