#include "precompute/transport/radiosity/links.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lightwell::transport {
namespace {

struct Link {
  uint32_t node;
  double value;
};

/// The links of one row.
class RowMerger {
 public:
  RowMerger(const FormFactors& factors, const PatchTree& tree, uint32_t row, float noise, float merge_error)
      : patch_(&factors.patch[factors.first[row]]), value_(&factors.value[factors.first[row]]), tree_(tree), noise_(noise), merge_error_(merge_error) {
    const uint32_t count = uint32_t(factors.first[row + 1] - factors.first[row]);
    const uint32_t top = tree.levelCount() - 1;
    uint32_t at = 0;
    for (uint32_t node = tree.level_first[top]; node < tree.level_first[top + 1]; ++node) {
      const uint32_t end = endOf(node, at, count);
      visit(node, top, at, end);
      at = end;
    }
    std::sort(links_.begin(), links_.end(), [](const Link& a, const Link& b) { return a.node < b.node; });
  }
  std::vector<Link> take() { return std::move(links_); }

 private:
  /// The end of the entries from `at` that lie below `node`.
  uint32_t endOf(uint32_t node, uint32_t at, uint32_t end) const {
    return uint32_t(std::lower_bound(patch_ + at, patch_ + end, tree_.end_patch[node]) - patch_);
  }

  double sum(uint32_t begin, uint32_t end) const { return std::accumulate(value_ + begin, value_ + end, 0.0); }

  /// Whether entries [begin, end) spread over `node` as area does, seen at its children and at its patches.
  bool isEven(uint32_t node, uint32_t level, uint32_t begin, uint32_t end, double total) const {
    const double per_area = total / tree_.area[node], noise2 = total * noise_, most2 = double(merge_error_) * merge_error_ + noise2;
    double at_patches = 0, covered = 0;
    for (uint32_t i = begin; i < end; ++i) {
      const double expected = per_area * tree_.area[patch_[i]];
      at_patches += (value_[i] - expected) * (value_[i] - expected);
      covered += tree_.area[patch_[i]];
    }
    // Patches without a hit, as if of equal areas: exact enough for a bound.
    const uint32_t patches = tree_.end_patch[node] - tree_.first_patch[node], missed = patches - (end - begin);
    if (missed > 0) {
      const double mean_missed = per_area * std::max(0.0, tree_.area[node] - covered) / missed;
      at_patches += missed * mean_missed * mean_missed;
    }
    if (at_patches > most2) return false;
    if (level < 2) return true;
    double at_children = 0;
    const uint32_t index = node - tree_.level_first[1];
    uint32_t at = begin;
    for (uint32_t child = tree_.first_child[index]; child < tree_.first_child[index + 1]; ++child) {
      const uint32_t child_end = endOf(child, at, end);
      const double difference = sum(at, child_end) - per_area * tree_.area[child];
      at_children += difference * difference;
      at = child_end;
    }
    return at_children <= most2;
  }

  void visit(uint32_t node, uint32_t level, uint32_t begin, uint32_t end) {
    if (begin == end) return;
    const double total = sum(begin, end);
    if (level == 0 || isEven(node, level, begin, end, total)) return void(links_.push_back({node, total}));
    const uint32_t index = node - tree_.level_first[1];
    uint32_t at = begin;
    for (uint32_t child = tree_.first_child[index]; child < tree_.first_child[index + 1]; ++child) {
      const uint32_t child_end = endOf(child, at, end);
      visit(child, level - 1, at, child_end);
      at = child_end;
    }
  }

  const uint32_t* patch_;
  const float* value_;
  const PatchTree& tree_;
  double noise_;
  float merge_error_;
  std::vector<Link> links_;
};

/// Drops the smallest links that carry at most `share` of all; what is left takes over.
void prune(std::vector<Link>& links, double share) {
  double total = 0;
  std::vector<double> ascending;
  for (const Link& link : links) {
    total += link.value;
    ascending.push_back(link.value);
  }
  std::sort(ascending.begin(), ascending.end());
  double dropped = 0, least = 0;
  for (const double value : ascending) {
    if (dropped + value > share * total) break;
    dropped += value;
    least = value;
  }
  if (dropped <= 0) return;
  double left = total;
  std::erase_if(links, [&](const Link& link) {
    if (link.value > least || left - link.value < (1 - share) * total) return false;
    left -= link.value;
    return true;
  });
  for (Link& link : links) link.value *= total / left;
}

}  // namespace

void RadiosityLinks::append(const RadiosityLinks& other) {
  const uint32_t base = uint32_t(node.size());
  for (size_t row = 1; row < other.first.size(); ++row) first.push_back(base + other.first[row]);
  node.insert(node.end(), other.node.begin(), other.node.end());
  code.insert(code.end(), other.code.begin(), other.code.end());
  row_scale.insert(row_scale.end(), other.row_scale.begin(), other.row_scale.end());
}

uint8_t linkCode(float weight) {
  if (weight <= 16.0f) return 0;
  int exponent = std::ilogb(weight) - 4;
  int mantissa = int(std::lround(std::ldexp(weight, -exponent))) - 16;
  if (mantissa == 16) mantissa = 0, ++exponent;
  return exponent > 15 ? 255 : uint8_t(exponent << 4 | mantissa);
}

RadiosityLinks makeLinks(const FormFactors& factors, const PatchTree& tree, uint32_t rays, const LinkOptions& options, uint32_t begin, uint32_t end) {
  RadiosityLinks result;
  for (uint32_t row = begin; row < end; ++row) {
    // Both ends' hits speak for a form factor, as a rule as many: half the variance of one end's.
    std::vector<Link> links;
    if (factors.first[row] < factors.first[row + 1]) links = RowMerger(factors, tree, row, 0.5f / float(rays), options.merge_error).take();
    double sum = 0, largest = 0;
    for (const Link& link : links) {
      sum += link.value;
      largest = std::max(largest, link.value);
    }
    prune(links, options.prune_share);
    uint64_t codes = 0;
    for (const Link& link : links) {
      result.node.push_back(link.node);
      result.code.push_back(linkCode(float(link.value / largest * linkWeight(255))));
      codes += linkWeight(result.code.back());
    }
    result.first.push_back(uint32_t(result.node.size()));
    result.row_scale.push_back(codes ? float(sum / double(codes)) : 0.0f);
  }
  return result;
}

}  // namespace lightwell::transport
