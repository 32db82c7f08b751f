#include "precompute/transport/prm/entries.h"

#include <algorithm>


namespace lightwell::transport {
namespace {

// Normals of one cluster span at most this chord along each axis: about 30°. Perpendicular walls are never mixed.
constexpr float kNormalExtent = 0.5f;
// A piece counts as flat when no texel is farther from the plane through its centroid than this share of its radius.
constexpr float kFlatness = 0.02f;

struct Member {
  Vec3 position, normal;
  float area;
};

/// One entry point for a piece of surface: its centroid, which makes the average of irradiance second-order accurate. Where the surface bends so much
/// that the centroid leaves it, the nearest texel's centroid.
void appendEntry(std::span<const Member> members, float total_area, PrmEntries& entries) {
  Vec3 centroid(0.0f), normal(0.0f);
  float area = 0, widest = 0;
  for (const auto& member : members) {
    centroid += member.position * member.area;
    normal += member.normal * member.area;
    area += member.area;
  }
  centroid /= area;
  const Member* nearest = &members[0];
  for (const auto& member : members) {
    if ((member.position - centroid).length2() < (nearest->position - centroid).length2()) nearest = &member;
    widest = std::max(widest, (member.position - centroid).length());
  }
  bool flat = true;
  for (const auto& member : members) flat = flat && std::abs((member.position - centroid).dot(nearest->normal)) <= kFlatness * widest;
  entries.position.push_back(flat ? centroid : nearest->position);
  entries.normal.push_back(flat ? normal.normalized() : nearest->normal);
  entries.weight.push_back(area / total_area);
}

/// Halves the members by area across their longest extent until `count` pieces are left, and adds a point for each.
void appendPieces(std::span<Member> members, uint32_t count, float total_area, PrmEntries& entries) {
  if (count <= 1 || members.size() == 1) return appendEntry(members, total_area, entries);
  Box3 box;
  double area = 0;
  for (const auto& member : members) {
    box.extendBy(member.position);
    area += member.area;
  }
  const int axis = box.majorAxis();
  std::stable_sort(members.begin(), members.end(), [axis](const Member& a, const Member& b) { return a.position[axis] < b.position[axis]; });
  const uint32_t left_count = count / 2;
  const double left_area = area * left_count / count;
  size_t split = 0;
  for (double sum = 0; split < members.size() && sum + 0.5 * members[split].area < left_area; ++split) sum += members[split].area;
  split = std::clamp<size_t>(split, 1, members.size() - 1);
  appendPieces(members.first(split), left_count, total_area, entries);
  appendPieces(members.subspan(split), count - left_count, total_area, entries);
}

/// `count` entry points (fewer where there are fewer texels) for the listed sides.
void appendEntries(const atlas::Atlas& atlas, const Sides& sides, std::span<const uint32_t> member_sides, uint32_t count, PrmEntries& entries) {
  std::vector<Member> members;
  float total_area = 0;
  for (const uint32_t side : member_sides) {
    const auto& slot = atlas.slots[sides.slot[side]];
    members.push_back({slot.position, sides.isBack(side) ? -slot.normal : slot.normal, slot.area});
    total_area += slot.area;
  }
  appendPieces(members, count, total_area, entries);
  entries.cluster_first_entry.push_back(uint32_t(entries.position.size()));
}

}  // namespace

EntryClusters makeEntries(const atlas::Atlas& atlas, const Sides& sides, const EntryOptions& options) {
  std::vector<SurfaceElement> elements;
  std::vector<uint32_t> element_side;
  for (uint32_t side = 0; side < sides.slot.size(); ++side) {
    const auto& slot = atlas.slots[sides.slot[side]];
    if (atlas.source[slot.texel] != slot.texel) continue;  // mostly buried: would only darken its cluster
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
    appendEntries(atlas, sides, membersOf(c, c + 1), options.points_per_cluster, result.entries);
  for (uint32_t g = 0; g < result.group_count; ++g) {
    const uint32_t first = result.group_first_cluster[g], end = result.group_first_cluster[g + 1];
    float area = 0;
    for (uint32_t c = first; c < end; ++c) area += result.area[c];
    result.area.push_back(area);
    appendEntries(atlas, sides, membersOf(first, end), options.points_per_group, result.entries);
  }
  return result;
}

}  // namespace lightwell::transport
