// The part of the clusters' tree that one block's response needs.
#pragma once
#include "precompute/transport/prm/entries.h"

namespace lightwell::transport {

/// The tree of the clusters' wavelets with what is derived from it.
struct WaveletIndex {
  explicit WaveletIndex(const EntryClusters& clusters);

  /// A child's clusters: [first, end).
  struct Leaves {
    uint32_t first, end;
  };
  Leaves leavesOf(uint32_t child) const {
    return child & WaveletTree::kLeaf ? Leaves{child & ~WaveletTree::kLeaf, (child & ~WaveletTree::kLeaf) + 1} : leaves[child];
  }

  uint32_t root;  // as a child
  std::vector<WaveletTree::Children> children;
  std::vector<Leaves> leaves;  // of each inner node
};

/// The tree without what is below small parts of groups of whose clusters no ray of the block met any: light from there comes by way of others only, and is
/// taken to be the mean's. Its leaves are clusters and such nodes; it is numbered as WaveletTree is.
struct ResponseTree {
  /// `met`: clusters, ascending.
  ResponseTree(const EntryClusters& clusters, const WaveletIndex& all, const std::vector<uint32_t>& met);

  uint32_t leaves = 0;
  WaveletTree shares;                           // `first_share` only
  std::vector<WaveletTree::Children> children;  // [inner nodes]
  std::vector<uint32_t> wavelet;                // [waveletCount(leaves)]: which of the whole tree's it is
  std::vector<uint32_t> leaf_of_cluster;        // [cluster of the whole tree]
  std::vector<uint32_t> group_of_leaf;
  std::vector<uint32_t> group_mean;             // [group]: the wavelet, of this tree, that is the mean over it
};

}  // namespace lightwell::transport
