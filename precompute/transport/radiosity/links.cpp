#include "precompute/transport/radiosity/links.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <tuple>

namespace lightwell::transport {
namespace {

using Vector = Eigen::RowVectorXf;  // one value per training light

/// A link of the row that is being compressed, and what it gets wrong: its share of the row's irradiance under each light, as it is minus as it should be.
struct Link {
  uint32_t node;
  uint32_t set;
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

/// Compresses single rows.
class RowMerger {
 public:
  RowMerger(const FormFactors& factors, const PatchTree& tree, const RadiosityTraining& training, const LinkOptions& options)
      : factors_(factors), tree_(tree), training_(training), node_radiosity_(nodeRadiosity(tree, training.radiosity)), mergeable_(nodesThatSeeTheSame(factors, tree)),
        options_(options), most_(options.link_error) {
    for (uint32_t set = 0; set < factors.sets.count(); ++set) class_.push_back(factors.sets.classOf(set));
    for (size_t c = 0; c < kGateClasses; ++c) counts_[c] = training.counts(GateClass(c));
  }

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
    segments_.clear();
    for (uint64_t i = factors_.first[row]; i < factors_.first[row + 1]; ++i) {
      if (segments_.empty() || segments_.back().set != factors_.setOf(i)) segments_.push_back({factors_.setOf(i), i, i});
      segments_.back().end = i + 1;
      if (factors_.value[i] > 0) links_.push_back({factors_.patch[i], factors_.setOf(i), factors_.value[i], Vector::Zero(lights)});
    }
  }

  /// What links of a set bring under each training light, per radiosity of a node.
  auto received(uint32_t set, uint32_t node) const { return node_radiosity_.row(node).cwiseProduct(counts_[size_t(class_[set])]); }

  /// Whether the form factors of `node` through `set`, together `value`, spread over it as its area does, seen at its patches and at its children.
  bool isEven(uint32_t node, uint32_t set, uint32_t level, double value) const {
    // Both ends' hits speak for a form factor, as a rule as many: half the variance of one end's.
    const double most2 = double(options_.uneven) * options_.uneven + 0.5 * value / options_.rays;
    const double per_area = value / tree_.area[node];
    const Segment& segment = *std::lower_bound(segments_.begin(), segments_.end(), set, [](const Segment& s, uint32_t wanted) { return s.set < wanted; });
    const auto all = std::span(factors_.patch).subspan(segment.begin, segment.end - segment.begin);
    const float* values = &factors_.value[segment.begin];
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
      const uint32_t set = links_[begin].set;
      if (begin > 0 && set != links_[begin - 1].set) node = tree_.level_first[level];
      while (tree_.end_patch[node] <= tree_.first_patch[links_[begin].node]) ++node;
      for (end = begin; end < links_.size() && links_[end].set == set && tree_.first_patch[links_[end].node] < tree_.end_patch[node];) ++end;
      if (end - begin < 2 || !mergeable_[node]) continue;
      Candidate candidate{node, begin, end, {node, set, 0.0f, Vector::Zero(training_.lights())}, 0.0f};
      Link& merged = candidate.merged;
      for (size_t i = begin; i < end; ++i) {
        merged.value += links_[i].value;
        merged.error += links_[i].error - links_[i].value * received(set, links_[i].node);
      }
      if (!isEven(node, set, level, merged.value)) continue;
      merged.error += merged.value * received(set, node);
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

  /// Drops the smallest links while the error allows; the others of their class take over what they carried.
  void prune() {
    std::vector<size_t> order(links_.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return links_[a].value < links_[b].value; });
    std::array<double, kGateClasses> total{}, left{};
    std::array<size_t, kGateClasses> links{};
    std::array<Vector, kGateClasses> brought;
    brought.fill(Vector::Zero(training_.lights()));
    for (const Link& link : links_) {
      const auto c = size_t(class_[link.set]);
      total[c] += link.value;
      ++links[c];
      brought[c] += link.value * received(link.set, link.node);
    }
    Vector exact = brought[0] - error_;
    for (size_t c = 1; c < classes(); ++c) exact += brought[c];
    left = total;
    std::vector<char> gone(links_.size(), 0);
    for (const size_t i : order) {
      const Link& link = links_[i];
      const auto of = size_t(class_[link.set]);
      const double rest_value = left[of] - link.value;
      if (links[of] < 2 || rest_value < (1 - options_.prune) * total[of]) {
        if (classes() == 1) break;
        continue;
      }
      const Vector rest = brought[of] - link.value * received(link.set, link.node);
      Vector scaled = rest * float(total[of] / rest_value);
      for (size_t c = 0; c < classes(); ++c)
        if (c != of && left[c] > 0) scaled += brought[c] * float(total[c] / left[c]);
      if (rms(scaled - exact) > most_) break;
      brought[of] = rest;
      left[of] = rest_value;
      --links[of];
      gone[i] = 1;
    }
    std::vector<Link> kept;
    for (size_t i = 0; i < links_.size(); ++i)
      if (!gone[i]) kept.push_back(std::move(links_[i]));
    if (kept.size() < links_.size())
      for (Link& link : kept) link.value *= float(total[size_t(class_[link.set])] / left[size_t(class_[link.set])]);
    links_ = std::move(kept);
  }

  size_t classes() const { return factors_.set.empty() ? 1 : kGateClasses; }

  /// The factors of the row that have the same set.
  struct Segment {
    uint32_t set;
    uint64_t begin, end;
  };

  const FormFactors& factors_;
  const PatchTree& tree_;
  const RadiosityTraining& training_;
  RadiosityTraining::Matrix node_radiosity_;
  std::vector<char> mergeable_;  // per node
  LinkOptions options_;
  float most_;
  std::vector<GateClass> class_;  // per set
  std::array<Vector, kGateClasses> counts_;  // of training lights
  uint32_t row_ = 0;
  std::vector<Segment> segments_;
  std::vector<Link> links_;
  Vector scale_, error_;  // of the row: one over its irradiance, and what its links get wrong together
};

/// Clears `same` of nodes whose patches cannot exchange light with all portals shut, not even by way of others, or depend on different gates.
void keepPlacesApart(const FormFactors& factors, const PatchTree& tree, std::vector<char>& same) {
  std::vector<uint32_t> parent(factors.rows());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto rootOf = [&](uint32_t patch) {
    while (parent[patch] != patch) patch = parent[patch] = parent[parent[patch]];
    return patch;
  };
  for (uint32_t row = 0; row < factors.rows(); ++row)
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i) {
      const GateClass gates = factors.sets.classOf(factors.setOf(i));
      if (gates != GateClass::always && gates != GateClass::closed) continue;
      const uint32_t a = rootOf(row), b = rootOf(factors.patch[i]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  using Place = std::pair<uint32_t, uint32_t>;  // of a patch: what it exchanges light with, and its gate
  constexpr Place kAnywhere{kNone, kNone};      // of patches that exchange no light
  std::vector<Place> place(tree.nodeCount(), kAnywhere);
  for (uint32_t patch = 0; patch < factors.rows(); ++patch)
    if (factors.first[patch] < factors.first[patch + 1]) place[patch] = {rootOf(patch), factors.own_gate.empty() ? kNone : factors.own_gate[patch]};
  for (uint32_t node = tree.level_first[1]; node < tree.nodeCount(); ++node) {
    const uint32_t index = node - tree.level_first[1];
    for (uint32_t child = tree.first_child[index]; child < tree.first_child[index + 1]; ++child) {
      if (place[child] == kAnywhere) continue;
      if (place[node] == kAnywhere) place[node] = place[child];
      if (place[child] != place[node]) same[node] = 0;
    }
  }
}

}  // namespace

std::vector<char> nodesThatSeeTheSame(const FormFactors& factors, const PatchTree& tree) {
  const uint32_t level = std::min(2u, tree.levelCount() - 1), first_bin = tree.level_first[level];
  std::vector<uint32_t> bin_of_patch(factors.rows());
  for (uint32_t node = first_bin; node < tree.level_first[level + 1]; ++node)
    std::fill(bin_of_patch.begin() + tree.first_patch[node], bin_of_patch.begin() + tree.end_patch[node], node - first_bin);
  // What every node sees, by larger nodes.
  RadiosityTraining::Matrix seen = RadiosityTraining::Matrix::Zero(tree.nodeCount(), Eigen::Index(tree.level_first[level + 1] - first_bin));
  for (uint32_t row = 0; row < factors.rows(); ++row)
    for (uint64_t i = factors.first[row]; i < factors.first[row + 1]; ++i)
      if (factors.setOf(i) == 0) seen(row, bin_of_patch[factors.patch[i]]) += factors.value[i];
  std::vector<char> same(tree.nodeCount(), 1);
  keepPlacesApart(factors, tree, same);
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
  set.insert(set.end(), other.set.begin(), other.set.end());
  value.insert(value.end(), other.value.begin(), other.value.end());
}

LinkValues makeLinks(const FormFactors& factors, const PatchTree& tree, const RadiosityTraining& training, const LinkOptions& options, uint32_t begin,
                     uint32_t end) {
  LinkValues result;
  result.sets = factors.sets;
  RowMerger merger(factors, tree, training, options);
  for (uint32_t row = begin; row < end; ++row) {
    std::vector<Link> links = merger.links(row);
    std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) { return a.set != b.set ? a.set < b.set : a.node < b.node; });
    for (const Link& link : links) {
      result.node.push_back(link.node);
      if (!factors.set.empty()) result.set.push_back(link.set);
      result.value.push_back(link.value);
    }
    result.first.push_back(uint32_t(result.node.size()));
  }
  return result;
}

}  // namespace lightwell::transport
