// Direct light on the entry clusters at all scales at once: a tree of clusters, and the Haar wavelets over it.
//
// Light from afar is smooth over a distant wall, so a block of texels needs few numbers to know all it receives from there (compare Ng, Ramamoorthi,
// Hanrahan: "All-Frequency Shadows Using Non-linear Wavelet Lighting Approximation").
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace lightwell::transport {

/// A binary tree whose leaves are the clusters in their order. Inner nodes are numbered in pre-order: a node, its first child's inner nodes, its second's.
struct WaveletTree {
  std::vector<uint32_t> first_leaves;  // [inner nodes]: clusters under the first child, at least 1
  std::vector<uint16_t> first_share;   // [inner nodes]: the first child's part of the node's area, times 65,536; at least 1

  /// A child is a cluster (kLeaf set) or an inner node.
  static constexpr uint32_t kLeaf = 0x80000000u;
  struct Children {
    uint32_t first, second;
  };
  /// The children of every inner node of a tree over `clusters` leaves; throws std::runtime_error when `first_leaves` is no such tree.
  std::vector<Children> children(uint32_t clusters) const;
  float shareOf(uint32_t node) const { return float(first_share[node]) * 0x1p-16f; }
};

/// What is known of the light, for c clusters: its value on every cluster, [0, c); its mean over every inner node, c + n; and for every inner node the
/// mean over the first child less that over the second, 2c − 1 + n.
inline uint32_t waveletCount(uint32_t clusters) { return clusters ? 3 * clusters - 2 : 0; }
inline uint32_t meanIndex(uint32_t clusters, uint32_t child) { return child & WaveletTree::kLeaf ? child & ~WaveletTree::kLeaf : clusters + child; }
inline uint32_t differenceIndex(uint32_t clusters, uint32_t node) { return 2 * clusters - 1 + node; }

/// From values on the clusters, [clusters][width], all of that, [waveletCount][width].
std::vector<float> toWavelets(const WaveletTree& tree, std::span<const WaveletTree::Children> children, uint32_t width, std::span<const float> cluster_value);

/// What a response to light on the clusters is to its wavelets, in the same places: to the mean over a node, were all light below even, and to the
/// difference. `response`: [waveletCount][width]; holds the clusters' and, at means, what whole subtrees give besides; the rest is overwritten.
///   t · d = t_first d_first + t_second d_second with d_first = mean + (1 − s) δ, d_second = mean − s δ (s the share of the first child)
/// so the response to the mean is the sum of both children's and that to δ is (1 − s) t_first − s t_second.
void responseToWavelets(const WaveletTree& tree, std::span<const WaveletTree::Children> children, uint32_t width, std::span<float> response);

/// Wavelets are stored and linked in units of their usual size under the lights that the bake foresees: a byte on a scale of 1/8 octaves.
float waveletUnit(uint8_t code);
/// The code of the unit next above `size`; 0 for what is smaller than the scale begins.
uint8_t waveletUnitCode(float size);

}  // namespace lightwell::transport
