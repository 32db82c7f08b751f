#include "precompute/transport/prm/merge_entries.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "precompute/transport/prm/entry_rectangle.h"

namespace lightwell::transport {
namespace {

class Merging {
 public:
  Merging(const PrmResult& prm, uint32_t most_points)
      : old_(prm), count_(prm.entries.clusterCount()), most_points_(most_points), children_(prm.bases.tree.children(count_)), detailed_(children_.size(), 0), new_wavelet_(waveletCount(count_), kGone) {
    std::vector<char> linked(waveletCount(count_), 0);
    for (const PrmBlocks* blocks : {static_cast<const PrmBlocks*>(&prm.bases), static_cast<const PrmBlocks*>(&prm.probes)})
      for (const uint32_t wavelet : blocks->link_wavelet) linked[wavelet] = 1;
    for (uint32_t n = uint32_t(children_.size()); n-- > 0;) {
      const auto below = [&](uint32_t child) { return linked[meanIndex(count_, child)] || (!(child & WaveletTree::kLeaf) && detailed_[child]); };
      detailed_[n] = linked[differenceIndex(count_, n)] || below(children_[n].first) || below(children_[n].second);
    }
  }

  uint32_t apply(PrmResult& prm) {
    entries_.cluster_first_entry.push_back(0);
    visit(count_ == 1 ? WaveletTree::kLeaf : 0);
    const uint32_t count = entries_.clusterCount();
    if (count == count_) return 0;
    std::vector<uint8_t> unit(waveletCount(count));
    for (uint32_t w = 0; w < new_wavelet_.size(); ++w) {
      if (new_wavelet_[w] == kGone) continue;
      // Inner nodes were numbered before it was known how many clusters there would be.
      if (new_wavelet_[w] & kMean) new_wavelet_[w] = meanIndex(count, new_wavelet_[w] & ~kMean);
      else if (new_wavelet_[w] & kDifference) new_wavelet_[w] = differenceIndex(count, new_wavelet_[w] & ~kDifference);
      unit[new_wavelet_[w]] = old_.bases.wavelet_unit[w];
    }
    relink(prm.bases);
    relink(prm.probes);
    prm.bases.wavelet_unit = std::move(unit);
    prm.bases.tree = std::move(tree_);
    prm.entries = std::move(entries_);
    return count_ - count;
  }

 private:
  static constexpr uint32_t kGone = 0xffffffffu, kMean = 0x80000000u, kDifference = 0x40000000u;

  /// Appends what becomes of a child, and returns its clusters.
  uint32_t visit(uint32_t child) {
    if (child & WaveletTree::kLeaf || !detailed_[child]) {
      new_wavelet_[meanIndex(count_, child)] = entries_.clusterCount();
      appendCluster(child);
      return 1;
    }
    const uint32_t node = uint32_t(tree_.first_leaves.size());
    new_wavelet_[meanIndex(count_, child)] = kMean | node;
    new_wavelet_[differenceIndex(count_, child)] = kDifference | node;
    tree_.first_leaves.push_back(0);
    tree_.first_share.push_back(old_.bases.tree.first_share[child]);
    const uint32_t first = visit(children_[child].first);
    tree_.first_leaves[node] = first;
    return first + visit(children_[child].second);
  }

  struct Part {
    uint32_t child;
    float weight;
  };

  std::array<Part, 2> halves(const Part& part) const {
    const float share = old_.bases.tree.shareOf(part.child);
    return {Part{children_[part.child].first, part.weight * share}, Part{children_[part.child].second, part.weight * (1 - share)}};
  }

  void appendCluster(uint32_t child) {
    std::vector<Part> parts = {{child, 1.0f}};
    while (parts.size() < most_points_) {
      Part* largest = nullptr;
      for (Part& part : parts)
        if (!(part.child & WaveletTree::kLeaf) && (!largest || part.weight > largest->weight)) largest = &part;
      if (!largest) break;
      const auto two = halves(*largest);
      *largest = two[0];
      parts.push_back(two[1]);
    }
    for (const Part& part : parts) appendPart(part);
    entries_.cluster_first_entry.push_back(uint32_t(entries_.position.size()));
  }

  void appendPart(const Part& part) {
    const PrmEntries& from = old_.entries;
    std::vector<Part> open = {{part.child, 1.0f}}, leaves;
    while (!open.empty()) {
      const Part next = open.back();
      open.pop_back();
      if (next.child & WaveletTree::kLeaf) leaves.push_back({next.child & ~WaveletTree::kLeaf, next.weight});
      else for (const Part& half : halves(next)) open.push_back(half);
    }
    if (leaves.size() == 1) {
      for (uint32_t i = from.cluster_first_entry[leaves[0].child]; i < from.cluster_first_entry[leaves[0].child + 1]; ++i) {
        entries_.position.push_back(from.position[i]), entries_.normal.push_back(from.normal[i]);
        entries_.half_u.push_back(from.half_u[i]), entries_.half_v.push_back(from.half_v[i]);
        entries_.weight.push_back(part.weight * from.weight[i]);
      }
      return;
    }
    std::vector<SurfacePiece> pieces;
    Vec3 centroid(0.0f), normal(0.0f);
    float area = 0;
    for (const Part& leaf : leaves)
      for (uint32_t i = from.cluster_first_entry[leaf.child]; i < from.cluster_first_entry[leaf.child + 1]; ++i) {
        const Vec3 &p = from.position[i], &u = from.half_u[i], &v = from.half_v[i];
        const float piece_area = 2 * u.length() * v.length();  // of each of two triangles
        const std::array<Vec3, 4> corner{p - u - v, p + u - v, p + u + v, p - u + v};
        for (const size_t second : {size_t(1), size_t(2)}) {
          SurfacePiece& piece = pieces.emplace_back();
          piece.corner = {corner[0], corner[second], corner[second + 1]};
          piece.centroid = (piece.corner[0] + piece.corner[1] + piece.corner[2]) / 3.0f;
          piece.normal = from.normal[i];
          piece.area = piece_area;
        }
        const float weight = leaf.weight * from.weight[i];
        centroid += p * weight, normal += from.normal[i] * weight;
        area += 2 * piece_area;
      }
    // The entry point next to the middle: the middle itself may lie inside of something.
    uint32_t nearest = from.cluster_first_entry[leaves[0].child];
    for (const Part& leaf : leaves)
      for (uint32_t i = from.cluster_first_entry[leaf.child]; i < from.cluster_first_entry[leaf.child + 1]; ++i)
        if ((from.position[i] - centroid).length2() < (from.position[nearest] - centroid).length2()) nearest = i;
    entries_.position.push_back(from.position[nearest]);
    entries_.normal.push_back(normal.length2() > 0 ? normal.normalized() : from.normal[nearest]);
    entries_.weight.push_back(part.weight);
    appendRectangle(pieces, centroid, area, entries_);
  }

  /// Links ascend by wavelet: a node that became a cluster moves before all others.
  void relink(PrmBlocks& blocks) const {
    size_t at = 0;
    for (size_t b = 0; b < blocks.block_rank.size(); ++b) {
      const uint32_t first = blocks.block_first_link[b], end = blocks.block_first_link[b + 1];
      const size_t width = size_t(blocks.block_rank[b]) * 3;
      std::vector<uint32_t> order(end - first);
      std::iota(order.begin(), order.end(), first);
      std::stable_sort(order.begin(), order.end(), [&](uint32_t x, uint32_t y) { return new_wavelet_[blocks.link_wavelet[x]] < new_wavelet_[blocks.link_wavelet[y]]; });
      std::vector<uint32_t> wavelet;
      std::vector<int8_t> coefficient;
      for (const uint32_t link : order) {
        wavelet.push_back(new_wavelet_[blocks.link_wavelet[link]]);
        const auto row = blocks.coefficient.begin() + std::ptrdiff_t(at + (link - first) * width);
        coefficient.insert(coefficient.end(), row, row + std::ptrdiff_t(width));
      }
      std::copy(wavelet.begin(), wavelet.end(), blocks.link_wavelet.begin() + first);
      std::copy(coefficient.begin(), coefficient.end(), blocks.coefficient.begin() + std::ptrdiff_t(at));
      at += (end - first) * width;
    }
  }

  const PrmResult& old_;
  const uint32_t count_, most_points_;
  const std::vector<WaveletTree::Children> children_;
  std::vector<char> detailed_;            // [inner node]: something below it is linked, or the difference between its children
  std::vector<uint32_t> new_wavelet_;
  WaveletTree tree_;
  PrmEntries entries_;
};

}  // namespace

uint32_t mergeUnlinked(PrmResult& prm, uint32_t most_points) {
  if (prm.entries.clusterCount() == 0) return 0;
  return Merging(prm, most_points).apply(prm);
}

}  // namespace lightwell::transport
