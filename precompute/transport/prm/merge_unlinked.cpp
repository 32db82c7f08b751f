#include "precompute/transport/prm/merge_unlinked.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>

#include "precompute/transport/prm/rectangle.h"

namespace lightwell::transport {
namespace {

// A light's shadow on a merged cluster is that at its middle, and a spot's beam may be as narrow as a few clusters.
constexpr uint32_t kMostLeaves = 16;
// Of a flat rectangle: how far normals differ at most, and how far its parts lie off its plane, in parts of its diagonal.
constexpr float kFlatNormal = 0.9999f, kFlatOffset = 1e-3f;
// The height, in parts of its side, above which what stands on a rectangle parts it.
constexpr float kLowest = 0.02f;

/// The entry point of a cluster.
struct Entry {
  Vec3 position, normal, half_u, half_v;

  float area() const { return 4.0f * half_u.length() * half_v.length(); }
  std::array<Vec3, 4> corners() const {
    return {position - half_u - half_v, position + half_u - half_v, position + half_u + half_v, position - half_u + half_v};
  }
};

/// Whether nothing stands on the surface between the middle of two rectangles and theirs: a wall, or a pole in the middle itself, where shadows are asked for.
bool seesMiddle(const trace::Tracer& tracer, const Entry& a, const Entry& b, const Entry& both) {
  const float height = kLowest * std::sqrt(both.area());
  std::array<trace::Ray, 2> rays;
  std::array<float, 2> transmittance{};
  for (size_t i = 0; i < 2; ++i) {
    const Entry& part = i ? b : a;
    rays[i] = {.origin = part.position + part.normal * height, .direction = both.position - part.position, .t_max = 1.001f};
  }
  tracer.transmittance(rays, transmittance);
  return transmittance[0] == 1 && transmittance[1] == 1;
}

/// The rectangle that two together are; nothing if they are none.
std::optional<Entry> joined(const trace::Tracer& tracer, const Entry& a, const Entry& b) {
  const float area = a.area() + b.area();
  if (!(a.area() > 0 && b.area() > 0) || a.normal.dot(b.normal) < kFlatNormal) return std::nullopt;
  Entry both;
  both.position = (a.position * a.area() + b.position * b.area()) / area;
  both.normal = (a.normal * a.area() + b.normal * b.area()).normalized();
  const Vec3 tangent = a.half_u.normalized(), bitangent = both.normal.cross(tangent).normalized();
  std::vector<Point2> outline;
  float offset = 0, reach = 0;
  for (const Entry* entry : {&a, &b})
    for (const Vec3& corner : entry->corners()) {
      const Vec3 from_middle = corner - both.position;
      outline.push_back({from_middle.dot(tangent), from_middle.dot(bitangent)});
      offset = std::max(offset, std::abs(from_middle.dot(both.normal)));
      reach = std::max(reach, from_middle.length());
    }
  if (offset > kFlatOffset * reach) return std::nullopt;
  const auto shape = rectangleAround(outline, area);
  if (!shape) return std::nullopt;
  std::tie(both.half_u, both.half_v) = halfSides(*shape, area, tangent, bitangent);
  if (!seesMiddle(tracer, a, b, both)) return std::nullopt;
  return both;
}

/// Which subtrees become one cluster each.
struct Merged {
  std::vector<std::optional<Entry>> node;  // [inner nodes]: the entry point of those that can
  std::vector<uint32_t> cluster;           // children of the tree (WaveletTree::kLeaf): what the clusters are now, in order
};

Entry entryOf(const PrmEntries& entries, uint32_t i) { return {entries.position[i], entries.normal[i], entries.half_u[i], entries.half_v[i]}; }

Merged mergedSubtrees(const trace::Tracer& tracer, const PrmEntries& entries, std::span<const WaveletTree::Children> children, const std::vector<char>& linked) {
  const uint32_t clusters = entries.clusterCount();
  Merged merged{std::vector<std::optional<Entry>>(children.size()), {}};
  std::vector<uint32_t> leaves(children.size());
  const auto leavesOf = [&](uint32_t child) { return child & WaveletTree::kLeaf ? 1 : leaves[child]; };
  const auto entry = [&](uint32_t child) {
    return child & WaveletTree::kLeaf ? std::optional(entryOf(entries, child & ~WaveletTree::kLeaf)) : merged.node[child];
  };
  for (uint32_t n = uint32_t(children.size()); n-- > 0;) {
    const auto [first, second] = children[n];
    leaves[n] = leavesOf(first) + leavesOf(second);
    if (leaves[n] > kMostLeaves || linked[differenceIndex(clusters, n)] || linked[meanIndex(clusters, first)] || linked[meanIndex(clusters, second)]) continue;
    const auto a = entry(first), b = entry(second);
    if (a && b) merged.node[n] = joined(tracer, *a, *b);
  }
  std::vector<uint32_t> open = {clusters == 1 ? WaveletTree::kLeaf : 0};
  while (!open.empty()) {
    const uint32_t child = open.back();
    open.pop_back();
    if (child & WaveletTree::kLeaf || merged.node[child]) {
      merged.cluster.push_back(child);
    } else {
      open.push_back(children[child].second);
      open.push_back(children[child].first);
    }
  }
  return merged;
}

/// Wavelets have other numbers: `number[old]`. Links of a block stay ascending.
void renumberLinks(std::span<const uint32_t> number, PrmBlocks& blocks) {
  size_t first_coefficient = 0;
  std::vector<uint32_t> order, wavelet;
  std::vector<int8_t> coefficient;
  for (size_t b = 0; b < blocks.block_rank.size(); ++b) {
    const uint32_t first = blocks.block_first_link[b], count = blocks.block_first_link[b + 1] - first;
    const size_t width = size_t(blocks.block_rank[b]) * 3;
    const auto number_of = [&](uint32_t l) { return number[blocks.link_wavelet[first + l]]; };
    order.resize(count);
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t l, uint32_t m) { return number_of(l) < number_of(m); });
    wavelet.clear(), coefficient.clear();
    for (const uint32_t l : order) {
      wavelet.push_back(number_of(l));
      const auto row = blocks.coefficient.begin() + std::ptrdiff_t(first_coefficient + l * width);
      coefficient.insert(coefficient.end(), row, row + std::ptrdiff_t(width));
    }
    std::copy(wavelet.begin(), wavelet.end(), blocks.link_wavelet.begin() + first);
    std::copy(coefficient.begin(), coefficient.end(), blocks.coefficient.begin() + std::ptrdiff_t(first_coefficient));
    first_coefficient += count * width;
  }
}

}  // namespace

uint32_t mergeUnlinkedClusters(const trace::Tracer& tracer, PrmResult& prm) {
  PrmLocalBases& bases = prm.bases;
  const uint32_t clusters = prm.entries.clusterCount();
  if (bases.block_rank.empty() || clusters < 2 || prm.entries.position.size() != clusters) return 0;
  const auto children = bases.tree.children(clusters);
  std::vector<char> linked(waveletCount(clusters), 0);
  for (const PrmBlocks* blocks : std::initializer_list<const PrmBlocks*>{&bases, &prm.probes})
    for (const uint32_t w : blocks->link_wavelet) linked[w] = 1;
  const Merged merged = mergedSubtrees(tracer, prm.entries, children, linked);
  const uint32_t left = uint32_t(merged.cluster.size());
  if (left == clusters) return 0;

  // The nodes above the new clusters keep their order, and pre-order with it.
  std::vector<uint32_t> number(linked.size(), UINT32_MAX), leaves(children.size(), 1);
  PrmEntries entries;
  entries.weight.assign(left, 1.0f);
  entries.cluster_first_entry.resize(left + 1);
  std::iota(entries.cluster_first_entry.begin(), entries.cluster_first_entry.end(), 0u);
  for (uint32_t c = 0; c < left; ++c) {
    const uint32_t child = merged.cluster[c];
    number[meanIndex(clusters, child)] = c;
    const Entry entry = child & WaveletTree::kLeaf ? entryOf(prm.entries, child & ~WaveletTree::kLeaf) : *merged.node[child];
    entries.position.push_back(entry.position), entries.normal.push_back(entry.normal);
    entries.half_u.push_back(entry.half_u), entries.half_v.push_back(entry.half_v);
  }
  std::vector<char> gone(children.size(), 0);  // inside a new cluster, or it itself
  WaveletTree tree;
  std::vector<uint32_t> kept;
  for (uint32_t n = 0; n < children.size(); ++n) {
    gone[n] = gone[n] || merged.node[n];
    for (const uint32_t child : {children[n].first, children[n].second})
      if (!(child & WaveletTree::kLeaf)) gone[child] = gone[n];
    if (gone[n]) continue;
    number[meanIndex(clusters, n)] = left + uint32_t(kept.size());
    number[differenceIndex(clusters, n)] = 2 * left - 1 + uint32_t(kept.size());
    kept.push_back(n);
    tree.first_share.push_back(bases.tree.first_share[n]);
  }
  const auto leavesOf = [&](uint32_t child) { return child & WaveletTree::kLeaf ? 1 : leaves[child]; };
  for (const uint32_t n : std::vector<uint32_t>(kept.rbegin(), kept.rend())) leaves[n] = leavesOf(children[n].first) + leavesOf(children[n].second);
  for (const uint32_t n : kept) tree.first_leaves.push_back(leavesOf(children[n].first));

  std::vector<uint8_t> unit(waveletCount(left));
  for (size_t w = 0; w < number.size(); ++w)
    if (number[w] != UINT32_MAX) unit[number[w]] = bases.wavelet_unit[w];
  renumberLinks(number, bases);
  renumberLinks(number, prm.probes);
  bases.wavelet_unit = std::move(unit), bases.tree = std::move(tree), prm.entries = std::move(entries);
  return clusters - left;
}

}  // namespace lightwell::transport
