#include "precompute/transport/prm/entries.h"

#include <algorithm>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

// Normals of one cluster span at most this chord along each axis: about 30°. Perpendicular walls are never mixed.
constexpr float kNormalExtent = 0.5f;

/// `count` points on the listed sides, spread by area: stratified along the list, so that every part gets its share.
void appendEntries(const scene::Mesh& mesh, const atlas::Atlas& atlas, const Sides& sides, std::span<const uint32_t> members, uint32_t count,
                   const Sampler& sampler, PrmEntries& entries) {
  std::vector<double> cumulative(members.size());
  double total = 0;
  for (size_t i = 0; i < members.size(); ++i) cumulative[i] = total += atlas.slots[sides.slot[members[i]]].area;
  for (uint32_t k = 0; k < count; ++k) {
    const double target = total * (k + sampler.get1D(k, 0)) / count;
    const size_t chosen = std::min<size_t>(std::upper_bound(cumulative.begin(), cumulative.end(), target) - cumulative.begin(), members.size() - 1);
    const auto point = sampleSide(mesh, atlas, sides, members[chosen], sampler.get1D(k, 1), sampler.get2D(k, 2));
    entries.position.push_back(point.position);
    entries.normal.push_back(point.normal);
    entries.weight.push_back(1.0f / count);
  }
  entries.cluster_first_entry.push_back(uint32_t(entries.position.size()));
}

}  // namespace

EntryClusters makeEntries(const scene::Mesh& mesh, const atlas::Atlas& atlas, const Sides& sides, const EntryOptions& options) {
  std::vector<SurfaceElement> elements;
  std::vector<uint32_t> element_side;
  for (uint32_t side = 0; side < sides.slot.size(); ++side) {
    const auto& slot = atlas.slots[sides.slot[side]];
    if (atlas.source[slot.texel] != slot.texel) continue;  // buried: no light arrives, no ray should find it
    elements.push_back({slot.position, sides.isBack(side) ? -slot.normal : slot.normal});
    element_side.push_back(side);
  }

  EntryClusters result;
  result.cluster_of_side.assign(sides.slot.size(), kNone);
  result.cluster_first_side.push_back(0);
  result.group_first_cluster.push_back(0);
  result.entries.cluster_first_entry.push_back(0);
  const Partition groups = partitionByCount(elements, options.groups, kNormalExtent, elements.size());
  const float fine_ratio = std::sqrt(float(std::max(1u, options.groups)) / float(std::max(options.clusters, options.groups)));

  // The fine clusters split each group on its own, at an extent common to all: smaller than the groups' by the square root of the ratio of counts.
  std::vector<float> group_extents;
  for (uint32_t g = 0; g < groups.count(); ++g) {
    Box3 box;
    for (uint32_t i = groups.first[g]; i < groups.first[g + 1]; ++i) box.extendBy(elements[groups.order[i]].position);
    group_extents.push_back(maxComponent(box.size()));
  }
  const float group_extent = group_extents.empty() ? 1.0f : *std::max_element(group_extents.begin(), group_extents.end());
  float fine = group_extent * fine_ratio * 0.25f, coarse = group_extent * fine_ratio * 4.0f;
  std::vector<Partition> split(groups.count());
  for (int step = 0; step < 10 && groups.count() > 0; ++step) {
    const float extent = std::sqrt(fine * coarse);
    size_t total = 0;
    for (uint32_t g = 0; g < groups.count(); ++g) {
      std::vector<SurfaceElement> members;
      for (uint32_t i = groups.first[g]; i < groups.first[g + 1]; ++i) members.push_back(elements[groups.order[i]]);
      split[g] = partitionByExtent(members, extent, kNormalExtent, members.size());
      total += split[g].count();
    }
    (total > options.clusters ? fine : coarse) = extent;
  }

  for (uint32_t g = 0; g < groups.count(); ++g) {
    for (uint32_t c = 0; c < split[g].count(); ++c) {
      float area = 0;
      for (uint32_t i = split[g].first[c]; i < split[g].first[c + 1]; ++i) {
        const uint32_t side = element_side[groups.order[groups.first[g] + split[g].order[i]]];
        result.cluster_of_side[side] = uint32_t(result.group_of_cluster.size());
        result.cluster_side.push_back(side);
        area += atlas.slots[sides.slot[side]].area;
      }
      result.cluster_first_side.push_back(uint32_t(result.cluster_side.size()));
      result.group_of_cluster.push_back(g);
      result.area.push_back(area);
    }
    result.group_first_cluster.push_back(uint32_t(result.group_of_cluster.size()));
  }
  result.cluster_count = uint32_t(result.group_of_cluster.size());
  result.group_count = groups.count();

  const auto membersOf = [&](uint32_t first_cluster, uint32_t end_cluster) {
    const uint32_t begin = result.cluster_first_side[first_cluster], end = result.cluster_first_side[end_cluster];
    return std::span<const uint32_t>(result.cluster_side).subspan(begin, end - begin);
  };
  for (uint32_t c = 0; c < result.cluster_count; ++c)
    appendEntries(mesh, atlas, sides, membersOf(c, c + 1), options.points_per_cluster, Sampler(options.seed, c), result.entries);
  for (uint32_t g = 0; g < result.group_count; ++g) {
    const uint32_t first = result.group_first_cluster[g], end = result.group_first_cluster[g + 1];
    float area = 0;
    for (uint32_t c = first; c < end; ++c) area += result.area[c];
    result.area.push_back(area);
    appendEntries(mesh, atlas, sides, membersOf(first, end), options.points_per_group, Sampler(options.seed, result.cluster_count + g), result.entries);
  }
  return result;
}

}  // namespace lightwell::transport
