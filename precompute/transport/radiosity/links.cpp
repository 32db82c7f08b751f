#include "precompute/transport/radiosity/links.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lightwell::transport {
namespace {

using Vector = Eigen::RowVectorXf;  // one value per training light

/// A link of the row that is being compressed, and what it gets wrong: its share of the row's irradiance under each light, as it is minus as it should be.
struct Link {
  uint32_t node;
  float value;
  Vector error;
};

/// Mean radiosities of all nodes.
RadiosityTraining::Matrix nodeRadiosity(const PatchTree& tree, const RadiosityTraining::Matrix& patch) {
  RadiosityTraining::Matrix node(tree.nodeCount(), patch.cols());
  node.topRows(patch.rows()) = patch;
  for (uint32_t i = tree.level_first[1]; i < tree.nodeCount(); ++i) {
    const uint32_t index = i - tree.level_first[1];
    node.row(i).setZero();
    for (uint32_t child = tree.first_child[index]; child < tree.first_child[index + 1]; ++child) node.row(i) += node.row(child) * tree.area[child];
    node.row(i) /= tree.area[i];
  }
  return node;
}

// What the patches of a node have to see in common, as a share: across a wall nothing, through a door a few hundredths, within a room about all.
constexpr float kSameSurroundings = 0.3f;

constexpr int kBalanceSweeps = 16;
constexpr double kMostGain = 2;  // of a sweep

/// Compresses single rows.
class RowMerger {
 public:
  RowMerger(const FormFactors& factors, const PatchTree& tree, const RadiosityTraining& training, const LinkOptions& options)
      : factors_(factors), tree_(tree), training_(training), node_radiosity_(nodeRadiosity(tree, training.radiosity)), mergeable_(nodesThatSeeTheSame(factors, tree)),
        options_(options), most_(options.link_error) {}

  std::vector<Link> links(uint32_t row) {
    begin(row);
    for (uint32_t level = 1; level < tree_.levelCount(); ++level) mergeInto(level);
    prune();
    return std::move(links_);
  }

 private:
  float rms(const Vector& error) const { return std::sqrt((error.array() * scale_.array()).square().mean()); }

  void begin(uint32_t row) {
    row_ = row;
    links_.clear();
    const Eigen::Index lights = training_.lights();
    scale_ = (training_.irradiance.row(row).array() + 0.1f).inverse().matrix();
    error_ = Vector::Zero(lights);
    for (uint64_t i = factors_.first[row]; i < factors_.first[row + 1]; ++i)
      if (factors_.value[i] > 0) links_.push_back({factors_.patch[i], factors_.value[i], Vector::Zero(lights)});
  }

  /// Whether the form factors of `node`, together `value`, spread over it as its area does, seen at its patches and at its children.
  bool isEven(uint32_t node, uint32_t level, double value) const {
    // Both ends' hits speak for a form factor, as a rule as many: half the variance of one end's.
    const double most2 = double(options_.uneven) * options_.uneven + 0.5 * value / options_.rays;
    const double per_area = value / tree_.area[node];
    const auto all = std::span(factors_.patch).subspan(factors_.first[row_], factors_.first[row_ + 1] - factors_.first[row_]);
    const float* values = &factors_.value[factors_.first[row_]];
    const auto at = [&](uint32_t patch) { return size_t(std::lower_bound(all.begin(), all.end(), patch) - all.begin()); };
    const size_t begin = at(tree_.first_patch[node]), end = at(tree_.end_patch[node]);
    double deviation2 = 0, missed_area = tree_.area[node];
    for (size_t i = begin; i < end; ++i) {
      const double area = tree_.area[all[i]], difference = values[i] - per_area * area;
      deviation2 += difference * difference;
      missed_area -= area;
    }
    // Patches without a hit, as if of equal areas: exact enough for a bound.
    const double missed = double(tree_.end_patch[node] - tree_.first_patch[node]) - double(end - begin);
    if (missed > 0) deviation2 += per_area * per_area * std::max(0.0, missed_area) * std::max(0.0, missed_area) / missed;
    if (deviation2 > most2 || level == 1) return deviation2 <= most2;
    deviation2 = 0;
    const uint32_t index = node - tree_.level_first[1];
    for (uint32_t child = tree_.first_child[index]; child < tree_.first_child[index + 1]; ++child) {
      double difference = -per_area * tree_.area[child];
      for (size_t i = at(tree_.first_patch[child]); i < at(tree_.end_patch[child]); ++i) difference += values[i];
      deviation2 += difference * difference;
    }
    return deviation2 <= most2;
  }

  /// Merges the links below nodes of `level`, those that cost least first, while the row's error allows. Links are in the order of their patches.
  void mergeInto(uint32_t level) {
    struct Candidate {
      uint32_t node;
      size_t begin, end;  // links
      Link merged;
      float cost;
    };
    std::vector<Candidate> candidates;
    uint32_t node = tree_.level_first[level];
    for (size_t begin = 0, end; begin < links_.size(); begin = end) {
      while (tree_.end_patch[node] <= tree_.first_patch[links_[begin].node]) ++node;
      for (end = begin; end < links_.size() && tree_.first_patch[links_[end].node] < tree_.end_patch[node];) ++end;
      if (end - begin < 2 || !mergeable_[node]) continue;
      Candidate candidate{node, begin, end, {node, 0.0f, Vector::Zero(training_.lights())}, 0.0f};
      Link& merged = candidate.merged;
      for (size_t i = begin; i < end; ++i) {
        merged.value += links_[i].value;
        merged.error += links_[i].error - links_[i].value * node_radiosity_.row(links_[i].node);
      }
      if (!isEven(node, level, merged.value)) continue;
      merged.error += merged.value * node_radiosity_.row(node);
      candidate.cost = rms(merged.error) / float(end - begin - 1);
      candidates.push_back(std::move(candidate));
    }
    std::stable_sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) { return a.cost < b.cost; });
    std::vector<char> gone(links_.size(), 0);
    for (Candidate& candidate : candidates) {
      Vector error = error_ + candidate.merged.error;
      for (size_t i = candidate.begin; i < candidate.end; ++i) error -= links_[i].error;
      if (rms(error) > most_ * shareOf(level)) continue;
      error_ = error;
      for (size_t i = candidate.begin + 1; i < candidate.end; ++i) gone[i] = 1;
      links_[candidate.begin] = std::move(candidate.merged);
    }
    size_t kept = 0;
    for (size_t i = 0; i < links_.size(); ++i)
      if (!gone[i]) {
        if (kept != i) links_[kept] = std::move(links_[i]);
        ++kept;
      }
    links_.resize(kept);
  }

  /// Every level may use a part of the error, so that the lowest does not spend it all.
  float shareOf(uint32_t level) const { return float(level) / float(tree_.levelCount()); }

  /// Drops the smallest links while the error allows; the others take over what they carried.
  void prune() {
    std::vector<size_t> order(links_.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return links_[a].value < links_[b].value; });
    double total = 0;
    Vector received = Vector::Zero(training_.lights());
    for (const Link& link : links_) {
      total += link.value;
      received += link.value * node_radiosity_.row(link.node);
    }
    const Vector exact = received - error_;
    double left = total;
    size_t dropped = 0;
    for (; dropped + 1 < order.size(); ++dropped) {
      const Link& link = links_[order[dropped]];
      const Vector rest = received - link.value * node_radiosity_.row(link.node);
      const double rest_value = left - link.value;
      if (rms(rest * float(total / rest_value) - exact) > most_ || rest_value < (1 - options_.prune) * total) break;
      received = rest;
      left = rest_value;
    }
    if (dropped == 0) return;
    std::vector<char> gone(links_.size(), 0);
    for (size_t i = 0; i < dropped; ++i) gone[order[i]] = 1;
    std::vector<Link> kept;
    for (size_t i = 0; i < links_.size(); ++i)
      if (!gone[i]) kept.push_back(std::move(links_[i]));
    for (Link& link : kept) link.value *= float(total / left);
    links_ = std::move(kept);
  }

  const FormFactors& factors_;
  const PatchTree& tree_;
  const RadiosityTraining& training_;
  RadiosityTraining::Matrix node_radiosity_;
  std::vector<char> mergeable_;  // per node
  LinkOptions options_;
  float most_;
  uint32_t row_ = 0;
  std::vector<Link> links_;
  Vector scale_, error_;  // of the row: one over its irradiance, and what its links get wrong together
};

}  // namespace

std::vector<char> nodesThatSeeTheSame(const FormFactors& factors, const PatchTree& tree) {
  const uint32_t level = std::min(2u, tree.levelCount() - 1), first_bin = tree.level_first[level];
  std::vector<uint32_t> bin_of_patch(factors.rows());
  for (uint32_t node = first_bin; node < tree.level_first[level + 1]; ++node)
    std::fill(bin_of_patch.begin() + tree.first_patch[node], bin_of_patch.begin() + tree.end_patch[node], node - first_bin);
  // What every node sees, by larger nodes.
  RadiosityTraining::Matrix seen = RadiosityTraining::Matrix::Zero(tree.nodeCount(), Eigen::Index(tree.level_first[level + 1] - first_bin));
  for (uint32_t row = 0; row < factors.rows(); ++row)
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) seen(row, bin_of_patch[factors.patch[i]]) += factors.value[i];
  std::vector<char> same(tree.nodeCount(), 1);
  for (uint32_t node = tree.level_first[1]; node < tree.nodeCount(); ++node) {
    const uint32_t index = node - tree.level_first[1], begin = tree.first_child[index], end = tree.first_child[index + 1];
    for (uint32_t child = begin; child < end; ++child) seen.row(node) += seen.row(child) * tree.area[child];
    for (uint32_t child = begin; child < end && same[node]; ++child) {
      if (!same[child]) same[node] = 0;
      if (end - begin < 2) continue;
      const Vector own = seen.row(child), others = (seen.row(node) - own * tree.area[child]) / std::max(tree.area[node] - tree.area[child], 1e-30f);
      const float less = std::min(own.sum(), others.sum());
      if (own.cwiseMin(others).sum() < kSameSurroundings * less) same[node] = 0;
    }
    seen.row(node) /= tree.area[node];
  }
  return same;
}

void LinkValues::append(const LinkValues& other) {
  const uint32_t base = uint32_t(node.size());
  for (size_t row = 1; row < other.first.size(); ++row) first.push_back(base + other.first[row]);
  node.insert(node.end(), other.node.begin(), other.node.end());
  value.insert(value.end(), other.value.begin(), other.value.end());
}

uint8_t linkCode(float weight) {
  if (weight <= 16.0f) return 0;
  int exponent = std::ilogb(weight) - 4;
  int mantissa = int(std::lround(std::ldexp(weight, -exponent))) - 16;
  if (mantissa == 16) mantissa = 0, ++exponent;
  return exponent > 15 ? 255 : uint8_t(exponent << 4 | mantissa);
}

LinkValues makeLinks(const FormFactors& factors, const PatchTree& tree, const RadiosityTraining& training, const LinkOptions& options, uint32_t begin,
                     uint32_t end) {
  LinkValues result;
  RowMerger merger(factors, tree, training, options);
  for (uint32_t row = begin; row < end; ++row) {
    std::vector<Link> links = merger.links(row);
    std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.node < b.node; });
    for (const Link& link : links) {
      result.node.push_back(link.node);
      result.value.push_back(link.value);
    }
    result.first.push_back(uint32_t(result.node.size()));
  }
  return result;
}

void balanceLinks(const PatchTree& tree, LinkValues& links) {
  const uint32_t patches = links.rows(), nodes = tree.nodeCount();
  std::vector<double> row_sum(patches, 0.0);
  for (uint32_t row = 0; row < patches; ++row)
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) row_sum[row] += links.value[l];
  for (int sweep = 0; sweep < kBalanceSweeps; ++sweep) {
    // What all patches together receive per area of each node's surface, at the node and from the nodes above it.
    std::vector<double> density(nodes, 0.0), gain(nodes, 0.0);
    for (uint32_t row = 0; row < patches; ++row)
      for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) density[links.node[l]] += double(tree.area[row]) * links.value[l] / tree.area[links.node[l]];
    for (uint32_t node = nodes; node-- > patches;)
      for (uint32_t child = tree.first_child[node - patches]; child < tree.first_child[node - patches + 1]; ++child) density[child] += density[node];
    for (uint32_t patch = 0; patch < patches; ++patch)
      gain[patch] = density[patch] > 0 ? std::clamp(row_sum[patch] / density[patch], 1 / kMostGain, kMostGain) : 1.0;
    for (uint32_t node = patches; node < nodes; ++node) {
      for (uint32_t child = tree.first_child[node - patches]; child < tree.first_child[node - patches + 1]; ++child) gain[node] += gain[child] * tree.area[child];
      gain[node] /= tree.area[node];
    }
    for (uint32_t row = 0; row < patches; ++row) {
      double sum = 0;
      for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) sum += links.value[l] * gain[links.node[l]];
      for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) links.value[l] = float(links.value[l] * gain[links.node[l]] * (row_sum[row] / sum));
    }
  }
}

RadiosityLinks quantiseLinks(const LinkValues& links) {
  RadiosityLinks result;
  result.first = links.first;
  result.node = links.node;
  for (uint32_t row = 0; row < links.rows(); ++row) {
    double sum = 0, largest = 0;
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) {
      sum += links.value[l];
      largest = std::max(largest, double(links.value[l]));
    }
    uint64_t codes = 0;
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) {
      result.code.push_back(linkCode(float(links.value[l] / largest * linkWeight(255))));
      codes += linkWeight(result.code.back());
    }
    result.row_scale.push_back(codes ? float(sum / double(codes)) : 0.0f);
  }
  return result;
}

}  // namespace lightwell::transport
