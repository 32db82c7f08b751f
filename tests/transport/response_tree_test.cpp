// The pruned tree of a block's response: what is kept, and that nothing is lost.
#include "precompute/transport/prm/response_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "precompute/transport/prm/hemisphere_bundle.h"
#include "precompute/transport/prm/linear_system.h"
#include "precompute/transport/prm/product.h"

namespace lightwell::transport {
namespace {

/// Groups of 1, 2, 5 and 8 clusters under a tree that is cut at random inside of groups.
EntryClusters someClusters(uint64_t seed) {
  EntryClusters clusters;
  const uint32_t sizes[] = {1, 2, 5, 8, 1, 7};
  clusters.group_first_cluster = {0};
  for (const uint32_t size : sizes) {
    for (uint32_t i = 0; i < size; ++i) clusters.group_of_cluster.push_back(clusters.group_count);
    clusters.group_first_cluster.push_back(uint32_t(clusters.group_of_cluster.size()));
    ++clusters.group_count;
  }
  clusters.cluster_count = uint32_t(clusters.group_of_cluster.size());
  std::mt19937_64 random(seed);
  // Pre-order: groups [first, end) first, then clusters.
  const auto share = [&] { return uint16_t(1 + random() % 65535); };
  const auto cutClusters = [&](const auto& self, uint32_t first, uint32_t end) -> void {
    if (end - first < 2) return;
    const uint32_t middle = first + 1 + uint32_t(random() % (end - first - 1));
    clusters.tree.first_leaves.push_back(middle - first), clusters.tree.first_share.push_back(share());
    self(self, first, middle), self(self, middle, end);
  };
  const auto cutGroups = [&](const auto& self, uint32_t first, uint32_t end) -> void {
    const auto& of = clusters.group_first_cluster;
    if (end - first < 2) return cutClusters(cutClusters, of[first], of[end]);
    const uint32_t middle = first + 1 + uint32_t(random() % (end - first - 1));
    clusters.tree.first_leaves.push_back(of[middle] - of[first]), clusters.tree.first_share.push_back(share());
    self(self, first, middle), self(self, middle, end);
  };
  cutGroups(cutGroups, 0, clusters.group_count);
  return clusters;
}

/// Response to all wavelets, [waveletCount], of clusters that were met and of groups.
std::vector<float> responseOfAll(const EntryClusters& clusters, const WaveletIndex& all, const std::vector<uint32_t>& met) {
  std::vector<float> response(waveletCount(clusters.cluster_count), 0.0f);
  for (const uint32_t c : met) response[c] += float(c + 1);
  const ResponseTree whole(clusters, all, [&] {
    std::vector<uint32_t> every(clusters.cluster_count);
    for (uint32_t c = 0; c < every.size(); ++c) every[c] = c;
    return every;
  }());
  for (uint32_t g = 0; g < clusters.group_count; ++g) response[whole.wavelet[whole.group_mean[g]]] += 100.0f * float(g + 1);
  responseToWavelets(clusters.tree, all.children, 1, response);
  return response;
}

TEST(ResponseTree, HasTheResponsesOfTheWholeTreeAndLeavesOutZerosOnly) {
  for (uint64_t seed = 1; seed < 40; ++seed) {
    const EntryClusters clusters = someClusters(seed);
    const WaveletIndex all(clusters);
    std::mt19937_64 random(seed);
    std::vector<uint32_t> met;
    for (uint32_t c = 0; c < clusters.cluster_count; ++c)
      if (random() % 6 == 0) met.push_back(c);
    const ResponseTree tree(clusters, all, met);
    EXPECT_EQ(tree.children.size() + 1, tree.leaves);
    ASSERT_EQ(tree.wavelet.size(), waveletCount(tree.leaves));
    ASSERT_EQ(tree.leaf_of_cluster.size(), clusters.cluster_count);
    std::vector<float> response(tree.wavelet.size(), 0.0f);
    for (size_t i = 0; i < met.size(); ++i) {
      EXPECT_EQ(tree.wavelet[tree.leaf_of_cluster[met[i]]], met[i]);
      response[tree.leaf_of_cluster[met[i]]] += float(met[i] + 1);
    }
    for (uint32_t c = 0; c < clusters.cluster_count; ++c) EXPECT_EQ(tree.group_of_leaf.at(tree.leaf_of_cluster[c]), clusters.group_of_cluster[c]);
    for (uint32_t g = 0; g < clusters.group_count; ++g) response[tree.group_mean[g]] += 100.0f * float(g + 1);
    responseToWavelets(tree.shares, tree.children, 1, response);
    const auto whole = responseOfAll(clusters, all, met);
    std::vector<char> kept(whole.size(), 0);
    for (size_t w = 0; w < response.size(); ++w) {
      EXPECT_NEAR(response[w], whole[tree.wavelet[w]], 1e-3f) << seed << " " << w;
      kept[tree.wavelet[w]] = 1;
    }
    for (uint32_t w = differenceIndex(clusters.cluster_count, 0); w < whole.size(); ++w) {
      if (kept[w]) continue;
      EXPECT_NEAR(whole[w], 0.0f, 1e-3f) << seed << " " << w;
    }
  }
}

TEST(ResponseTree, HasSmallPartsOfGroupsForLeavesWhereNothingIsMet) {
  const EntryClusters clusters = someClusters(7);
  const ResponseTree tree(clusters, WaveletIndex(clusters), {});
  std::vector<uint32_t> size(tree.leaves, 0);
  for (const uint32_t leaf : tree.leaf_of_cluster) ++size.at(leaf);
  EXPECT_EQ(*std::max_element(size.begin(), size.end()), 4u);
  EXPECT_GE(tree.leaves, clusters.group_count);
  EXPECT_LT(tree.leaves, clusters.cluster_count);
}

TEST(HemisphereBundle, IsEvenByTheCosineAndKeepsNeighboursTogether) {
  const HemisphereBundle bundle(4096, 1, 2);
  ASSERT_EQ(bundle.directions.size(), 4096u);
  Vec3d mean(0.0), square(0.0);
  double step = 0;
  for (size_t i = 0; i < bundle.directions.size(); ++i) {
    const Vec3d d(bundle.directions[i]);
    EXPECT_NEAR(d.length(), 1.0, 1e-5);
    EXPECT_GE(d.z, 0.0);
    mean += d / 4096.0, square += d * d / 4096.0;
    if (i > 0) step += (d - Vec3d(bundle.directions[i - 1])).length() / 4095.0;
  }
  // Of a density of cos / π: E z = 2/3, E z² = 1/2, E x² = 1/4.
  EXPECT_LT((mean - Vec3d(0, 0, 2.0 / 3)).length(), 1e-3);
  EXPECT_LT((square - Vec3d(0.25, 0.25, 0.5)).length(), 1e-3);
  EXPECT_LT(step, 0.1);  // random neighbours are 0.9 apart
}

TEST(Product, IsThatOfPlainLoops) {
  std::mt19937 random(4);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (const auto& [rows, inner, columns] : {std::array{1, 1, 1}, std::array{3, 17, 5}, std::array{48, 301, 130}}) {
    const Eigen::MatrixXf a = Eigen::MatrixXf::NullaryExpr(rows, inner, [&] { return uniform(random); });
    const RowMajorMatrix wide = RowMajorMatrix::NullaryExpr(inner, columns + 9, [&] { return uniform(random); });
    const RowMajorMatrix c = multiply(a, wide.middleCols(4, columns));
    for (int r = 0; r < rows; ++r)
      for (int k = 0; k < columns; ++k) {
        double sum = 0;
        for (int i = 0; i < inner; ++i) sum += double(a(r, i)) * double(wide(i, k + 4));
        EXPECT_NEAR(c(r, k), sum, 1e-4) << rows << " " << r << " " << k;
      }
    RowMajorMatrix plain(rows, columns);  // as on a machine without AVX2
    multiplyByEigen({rows, inner, columns, a.data(), wide.data() + 4, wide.outerStride(), plain.data()});
    EXPECT_LT((plain - c).cwiseAbs().maxCoeff(), 1e-4f);
  }
}

TEST(Product, OfSparseRowsIsThatOfPlainLoops) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> uniform(-1, 1);
  for (const auto& [rows, inner, columns] : {std::array{1, 1, 1}, std::array{5, 40, 7}, std::array{9, 30, 8}, std::array{48, 301, 155}}) {
    SparseRows a;
    for (int r = 0; r < rows; ++r) {
      for (int i = r % 3; i < inner && r != 2; i += 1 + int(random() % 5)) a.column.push_back(uint32_t(i)), a.value.push_back(uniform(random));
      a.first.push_back(uint32_t(a.column.size()));
    }
    const RowMajorMatrix wide = RowMajorMatrix::NullaryExpr(inner, columns + 9, [&] { return uniform(random); });
    RowMajorMatrix c = RowMajorMatrix::Constant(rows, columns + 3, 7.0f);
    multiply(a, wide.middleCols(4, columns), c.middleCols(2, columns));
    for (int r = 0; r < rows; ++r)
      for (int k = 0; k < columns + 3; ++k) {
        double sum = 0;
        for (uint32_t i = a.first[size_t(r)]; i < a.first[size_t(r) + 1]; ++i) sum += double(a.value[i]) * double(wide(a.column[i], std::max(0, k - 2) + 4));
        EXPECT_NEAR(c(r, k), k < 2 || k == columns + 2 ? 7.0 : sum, 1e-4) << rows << " " << r << " " << k;
      }
    RowMajorMatrix plain(rows, columns);  // as on a machine without AVX2
    multiplySparseByVectors({&a, columns, wide.data() + 4, wide.outerStride(), plain.data(), columns});
    EXPECT_LT((plain - c.middleCols(2, columns)).cwiseAbs().maxCoeff(), 1e-4f);
  }
}

TEST(LinearSystem, IsSolvedWithPivots) {
  std::mt19937 random(6);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const int size : {1, 2, 37, 300}) {
    Eigen::MatrixXd a = Eigen::MatrixXd::NullaryExpr(size, size, [&] { return uniform(random); });
    if (size > 1) a(0, 0) = 0;
    const Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(size, size, [&] { return uniform(random); });
    EXPECT_LT((solve(a, a * x) - x).norm(), 1e-9 * size * x.norm()) << size;
    // As the solution of bounces is: I - R with rows of R that add up to 0.95.
    const Eigen::MatrixXd r = a.cwiseAbs() * (0.95 / a.cwiseAbs().rowwise().sum().maxCoeff()), system = Eigen::MatrixXd::Identity(size, size) - r;
    const Eigen::MatrixXd exact = solve(system, r);
    EXPECT_LT((solve(Eigen::MatrixXf(system.cast<float>()), Eigen::MatrixXf(r.cast<float>())).cast<double>() - exact).norm(), 1e-5 * exact.norm()) << size;
  }
}

}  // namespace
}  // namespace lightwell::transport
