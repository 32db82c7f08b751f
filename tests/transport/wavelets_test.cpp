// Wavelets of light over a tree of clusters: responses to them are those to the clusters, in every basis that the tree has.
#include "precompute/transport/prm/wavelets.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <stdexcept>

namespace lightwell::transport {
namespace {

struct RandomTree {
  std::mt19937 engine;
  WaveletTree tree;
  std::vector<std::vector<uint32_t>> under;  // [inner node]: its clusters
  explicit RandomTree(uint32_t clusters, uint32_t seed) : engine(seed) { split(0, clusters); }
  double uniform() { return double(engine()) / 4294967296.0; }

 private:
  void split(uint32_t first_leaf, uint32_t leaves) {
    if (leaves < 2) return;
    const auto first = uint32_t(1 + uniform() * (leaves - 1));
    tree.first_leaves.push_back(first);
    tree.first_share.push_back(uint16_t(1 + uniform() * 65535));
    under.emplace_back(leaves);
    std::iota(under.back().begin(), under.back().end(), first_leaf);
    split(first_leaf, first);
    split(first_leaf + first, leaves - first);
  }
};

/// Weights of the clusters in the mean over a child, in double, straight from the definition.
void addMean(const WaveletTree& tree, std::span<const WaveletTree::Children> children, uint32_t child, double weight,
             std::vector<double>& weights) {
  if (child & WaveletTree::kLeaf) {
    weights[child & ~WaveletTree::kLeaf] += weight;
    return;
  }
  const double share = tree.first_share[child] / 65536.0;
  addMean(tree, children, children[child].first, weight * share, weights);
  addMean(tree, children, children[child].second, weight * (1 - share), weights);
}

std::vector<uint32_t> leavesOf(std::span<const WaveletTree::Children> children, uint32_t child) {
  if (child & WaveletTree::kLeaf) return {child & ~WaveletTree::kLeaf};
  std::vector<uint32_t> leaves = leavesOf(children, children[child].first);
  for (const uint32_t leaf : leavesOf(children, children[child].second)) leaves.push_back(leaf);
  return leaves;
}

TEST(WaveletTree, ChildrenFollowInPreOrder) {
  for (uint32_t seed = 0; seed < 50; ++seed) {
    const uint32_t clusters = 1 + seed * 3;
    const RandomTree random(clusters, seed);
    const auto children = random.tree.children(clusters);
    ASSERT_EQ(children.size(), clusters - 1);
    for (uint32_t n = 0; n + 1 < clusters; ++n) EXPECT_EQ(leavesOf(children, n), random.under[n]) << n;
  }
  EXPECT_TRUE(WaveletTree().children(0).empty());
  EXPECT_TRUE(WaveletTree().children(1).empty());
}

TEST(WaveletTree, BrokenOnesAreRejected) {
  const WaveletTree sound{{2, 1, 1}, {1, 2, 3}};
  EXPECT_NO_THROW(sound.children(4));
  EXPECT_THROW(sound.children(3), std::runtime_error);
  EXPECT_THROW(sound.children(5), std::runtime_error);
  EXPECT_THROW(sound.children(0), std::runtime_error);
  for (const uint32_t node : {0u, 1u, 2u})
    for (const uint32_t leaves : {0u, node ? 2u : 4u, 0xffffffffu}) {
      WaveletTree broken = sound;
      broken.first_leaves[node] = leaves;
      EXPECT_THROW(broken.children(4), std::runtime_error) << node << " " << leaves;
    }
  WaveletTree short_of_shares = sound;
  short_of_shares.first_share.pop_back();
  EXPECT_THROW(short_of_shares.children(4), std::runtime_error);
}

TEST(Wavelets, AreMeansAndDifferencesByShares) {
  constexpr uint32_t kClusters = 70, kWidth = 3;
  RandomTree random(kClusters, 3);
  const auto children = random.tree.children(kClusters);
  std::vector<float> value(kClusters * kWidth);
  for (float& v : value) v = float(random.uniform());
  const auto wavelets = toWavelets(random.tree, children, kWidth, value);
  ASSERT_EQ(wavelets.size(), size_t(waveletCount(kClusters)) * kWidth);
  EXPECT_TRUE(std::equal(value.begin(), value.end(), wavelets.begin()));
  for (uint32_t n = 0; n + 1 < kClusters; ++n) {
    std::vector<double> mean(kClusters), first(kClusters), second(kClusters);
    addMean(random.tree, children, n, 1, mean);
    addMean(random.tree, children, children[n].first, 1, first);
    addMean(random.tree, children, children[n].second, 1, second);
    for (uint32_t k = 0; k < kWidth; ++k) {
      double expected_mean = 0, expected_difference = 0;
      for (uint32_t c = 0; c < kClusters; ++c) {
        expected_mean += mean[c] * value[c * kWidth + k];
        expected_difference += (first[c] - second[c]) * value[c * kWidth + k];
      }
      EXPECT_NEAR(wavelets[(kClusters + n) * kWidth + k], expected_mean, 1e-5);
      EXPECT_NEAR(wavelets[(2 * kClusters - 1 + n) * kWidth + k], expected_difference, 1e-5);
    }
  }
}

/// What the wavelets of a basis give: of each chosen subtree its mean, and all differences below.
double answer(std::span<const WaveletTree::Children> children, std::span<const float> response, std::span<const float> wavelets,
              uint32_t child) {
  const uint32_t clusters = uint32_t(children.size()) + 1, at = meanIndex(clusters, child);
  double sum = double(response[at]) * wavelets[at];
  std::vector<uint32_t> waiting{child};
  while (!waiting.empty()) {
    const uint32_t node = waiting.back();
    waiting.pop_back();
    if (node & WaveletTree::kLeaf) continue;
    const uint32_t difference = differenceIndex(clusters, node);
    sum += double(response[difference]) * wavelets[difference];
    waiting.insert(waiting.end(), {children[node].first, children[node].second});
  }
  return sum;
}

TEST(Wavelets, ResponsesAreAdjointInEveryBasis) {
  for (const uint32_t clusters : {1u, 2u, 3u, 20u, 300u}) {
    RandomTree random(clusters, clusters);
    const auto children = random.tree.children(clusters);
    std::vector<float> value(clusters), response(waveletCount(clusters), std::numeric_limits<float>::quiet_NaN());
    for (float& v : value) v = float(2 * random.uniform() - 0.5);
    const auto wavelets = toWavelets(random.tree, children, 1, value);
    // To clusters, and besides to means over subtrees.
    double expected = 0, magnitude = 0;
    for (uint32_t w = 0; w < 2 * clusters - 1; ++w) {
      response[w] = float(random.uniform() - 0.3);
      expected += double(response[w]) * wavelets[w];
      magnitude += std::abs(double(response[w]) * wavelets[w]);
    }
    responseToWavelets(random.tree, children, 1, response);
    double over_clusters = 0;
    for (uint32_t c = 0; c < clusters; ++c) over_clusters += double(response[c]) * value[c];
    EXPECT_NEAR(over_clusters, expected, 1e-5 * magnitude);
    const uint32_t root = clusters == 1 ? WaveletTree::kLeaf : 0;
    EXPECT_NEAR(answer(children, response, wavelets, root), expected, 1e-5 * magnitude);
    for (int trial = 0; trial < 20; ++trial) {
      double mixed = 0;
      std::vector<uint32_t> waiting{root};
      while (!waiting.empty()) {
        const uint32_t child = waiting.back();
        waiting.pop_back();
        if (child & WaveletTree::kLeaf || random.uniform() < 0.2) mixed += answer(children, response, wavelets, child);
        else waiting.insert(waiting.end(), {children[child].first, children[child].second});
      }
      EXPECT_NEAR(mixed, expected, 1e-5 * magnitude);
    }
  }
}

TEST(WaveletUnit, IsNextAboveWithinAnEighthOfAnOctave) {
  EXPECT_EQ(waveletUnitCode(1), 160);
  EXPECT_EQ(waveletUnit(160), 1.0f);
  EXPECT_EQ(waveletUnit(168), 2.0f);
  for (double octave = -19.9; octave < 11.8; octave += 0.0137) {
    const float size = float(std::exp2(octave)), unit = waveletUnit(waveletUnitCode(size));
    ASSERT_GE(unit, size * (1 - 1e-5f));
    ASSERT_LE(unit, size * std::exp2(0.125f) * (1 + 1e-5f));
  }
  for (int code = 1; code < 256; ++code) EXPECT_EQ(waveletUnitCode(waveletUnit(uint8_t(code)) * 0.999f), code) << code;
  for (const float nothing : {0.0f, -1.0f, 1e-9f, std::numeric_limits<float>::quiet_NaN()})
    EXPECT_EQ(waveletUnitCode(nothing), 0) << nothing;
  EXPECT_EQ(waveletUnitCode(1e9f), 255);
  EXPECT_EQ(waveletUnitCode(std::numeric_limits<float>::infinity()), 255);
}

}  // namespace
}  // namespace lightwell::transport
