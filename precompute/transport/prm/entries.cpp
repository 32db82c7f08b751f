#include "precompute/transport/prm/entries.h"

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "precompute/core/parallel.h"
#include "precompute/transport/exposure.h"
#include "precompute/transport/side_rays.h"
#include "precompute/transport/prm/gather.h"
#include "precompute/transport/prm/rectangle.h"
#include "precompute/transport/prm/unreached.h"

namespace lightwell::transport {
namespace {

// Normals of one cluster span at most this chord along each axis: about 30°. Perpendicular walls are never mixed.
constexpr float kNormalExtent = 0.5f;
// Rays of each of two samples of what a cluster sees, and the common share below which two neighbours are taken to be apart, as a part of what the two
// samples of one cluster have in common: across a wall nothing, through a door a few hundredths, within a room about all.
constexpr uint32_t kSurroundingRays = 64;
constexpr float kSameSurroundings = 0.3f;
constexpr uint64_t kSurroundingStream = 1ull << 32;

// Rays that measure how far a texel's side sees, and the spacing of entries where that is hardly anything, relative to that in the open.
constexpr uint32_t kViewRays = 16;
constexpr float kLeastSpacing = 0.1f;
constexpr uint64_t kViewStream = 5ull << 40;

/// A patch of a cluster's surface.
struct Member {
  std::array<Vec3, 3> corner;
  Vec3 centroid, normal;
  float area;
};

Vec3 closestPointOnEdge(const Vec3& a, const Vec3& b, const Vec3& point) {
  const Vec3 edge = b - a;
  const float length2 = edge.length2();
  return length2 > 0 ? a + edge * std::clamp((point - a).dot(edge) / length2, 0.0f, 1.0f) : a;
}

Vec3 closestPointOnTriangle(const std::array<Vec3, 3>& corner, const Vec3& point) {
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
  bool inside = normal.length2() > 0;
  for (int i = 0; i < 3; ++i) inside = inside && normal.cross(corner[(i + 1) % 3] - corner[i]).dot(point - corner[i]) >= 0;
  if (inside) return point - normal * ((point - corner[0]).dot(normal) / normal.length2());
  Vec3 closest = closestPointOnEdge(corner[0], corner[1], point);
  for (int i = 1; i < 3; ++i) {
    const Vec3 candidate = closestPointOnEdge(corner[i], corner[(i + 1) % 3], point);
    if ((candidate - point).length2() < (closest - point).length2()) closest = candidate;
  }
  return closest;
}

/// The rectangle about the entry point just appended, of the piece's area: the piece itself where it is one, else with the axes and the proportions of its second
/// moments. A square has no axes of its moments.
void appendRectangle(std::span<const Member> members, const Vec3& centroid, float area, PrmEntries& entries) {
  Vec3 tangent, bitangent;
  orthonormalBasis(entries.normal.back(), tangent, bitangent);
  double uu = 0, uv = 0, vv = 0;
  std::vector<Point2> outline;
  for (const auto& member : members) {
    // A triangle's moment about a point: that of its mean point, and the spread of its corners about that, a twelfth of the sum of squares.
    const auto add = [&](const Vec3& offset, double weight) {
      const double u = offset.dot(tangent), v = offset.dot(bitangent);
      uu += weight * u * u, uv += weight * u * v, vv += weight * v * v;
    };
    add(member.centroid - centroid, member.area);
    for (const auto& corner : member.corner) {
      add(corner - member.centroid, double(member.area) / 12);
      outline.push_back({(corner - centroid).dot(tangent), (corner - centroid).dot(bitangent)});
    }
  }
  const double middle = 0.5 * (uu + vv), spread = std::hypot(0.5 * (uu - vv), uv);
  const double least = std::max(1e-4 * (middle + spread), middle - spread);  // slivers stay rectangles
  RectangleShape shape{0.5 * std::atan2(2 * uv, uu - vv), least > 0 ? std::sqrt((middle + spread) / least) : 1.0};
  if (const auto rectangle = rectangleAround(outline, area)) shape = *rectangle;
  const auto [half_u, half_v] = halfSides(shape, area, tangent, bitangent);
  entries.half_u.push_back(half_u), entries.half_v.push_back(half_v);
}

/// One entry point for a piece of surface: the point of it next to its centroid, which makes the average of irradiance second-order accurate on
/// flat pieces. The centroid itself may lie inside a column or under a box, where no light comes.
void appendEntry(std::span<const Member> members, float total_area, PrmEntries& entries) {
  Vec3 centroid(0.0f), normal(0.0f);
  float area = 0;
  for (const auto& member : members) {
    centroid += member.centroid * member.area;
    normal += member.normal * member.area;
    area += member.area;
  }
  centroid /= area;
  Vec3 position(0.0f);
  Vec3 normal_there(0.0f);
  float distance2 = std::numeric_limits<float>::infinity();
  for (const auto& member : members) {
    const Vec3 candidate = closestPointOnTriangle(member.corner, centroid);
    if ((candidate - centroid).length2() >= distance2) continue;
    distance2 = (candidate - centroid).length2();
    position = candidate;
    normal_there = member.normal;
  }
  entries.position.push_back(position);
  entries.normal.push_back(normal.length2() > 0 ? normal.normalized() : normal_there);
  entries.weight.push_back(area / total_area);
  appendRectangle(members, centroid, area, entries);
}

/// Halves the members by area across their longest extent until `count` pieces are left, and adds a point for each.
void appendPieces(std::span<Member> members, uint32_t count, float total_area, PrmEntries& entries) {
  if (count <= 1 || members.size() == 1) return appendEntry(members, total_area, entries);
  Box3 box;
  double area = 0;
  for (const auto& member : members) {
    box.extendBy(member.centroid);
    area += member.area;
  }
  const int axis = box.majorAxis();
  std::stable_sort(members.begin(), members.end(), [axis](const Member& a, const Member& b) { return a.centroid[axis] < b.centroid[axis]; });
  const uint32_t left_count = count / 2;
  const double left_area = area * left_count / count;
  size_t split = 0;
  for (double sum = 0; split < members.size() && sum + 0.5 * members[split].area < left_area; ++split) sum += members[split].area;
  split = std::clamp<size_t>(split, 1, members.size() - 1);
  appendPieces(members.first(split), left_count, total_area, entries);
  appendPieces(members.subspan(split), count - left_count, total_area, entries);
}

/// `count` entry points (fewer where there are fewer patches) for the listed sides.
void appendEntries(const scene::Mesh& mesh, const atlas::Atlas& atlas, const Sides& sides, std::span<const float> exposed,
                   std::span<const uint32_t> member_sides, uint32_t count, PrmEntries& entries) {
  std::vector<Member> members;
  float total_area = 0;
  for (const uint32_t side : member_sides) {
    const auto& slot = atlas.slots[sides.slot[side]];
    for (const auto& patch : std::span(atlas.patches).subspan(slot.first_patch, slot.patch_count)) {
      Member member;
      for (int i = 0; i < 3; ++i) member.corner[i] = atlas::surfacePoint(mesh, patch.triangle, patch.corner[i].x, patch.corner[i].y).position;
      const Vec2 middle = (patch.corner[0] + patch.corner[1] + patch.corner[2]) / 3.0f;
      const auto point = atlas::surfacePoint(mesh, patch.triangle, middle.x, middle.y);
      member.centroid = point.position;
      member.normal = sides.isBack(side) ? -point.normal : point.normal;
      member.area = patch.area * exposed[side];
      total_area += member.area;
      members.push_back(member);
    }
  }
  appendPieces(members, count, total_area, entries);
  entries.cluster_first_entry.push_back(uint32_t(entries.position.size()));
}

/// Fine clusters as lists of sides, those of one group in a row.
struct ClusterList {
  std::vector<uint32_t> cluster_first_side = {0}, cluster_side;
  std::vector<uint32_t> group_of_cluster;
  std::span<const uint32_t> sides(uint32_t cluster) const {
    return std::span<const uint32_t>(cluster_side).subspan(cluster_first_side[cluster], cluster_first_side[cluster + 1] - cluster_first_side[cluster]);
  }
  void append(std::span<const uint32_t> sides_of_cluster, uint32_t group) {
    cluster_side.insert(cluster_side.end(), sides_of_cluster.begin(), sides_of_cluster.end());
    cluster_first_side.push_back(uint32_t(cluster_side.size()));
    group_of_cluster.push_back(group);
  }
};

/// How dense entries must be on each side: as far as the side sees (the harmonic mean distance to what is around it, which also spaces the records of
/// irradiance caching: Ward, Rubinstein, Clear: "A Ray Tracing Solution for Diffuse Interreflection"), relative to the median; at most 1. Light varies as
/// fast as its surroundings are near, and a cluster must not reach from the open into a gap.
std::vector<float> entrySpacing(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, uint64_t seed,
                                int threads, const CancelFlag* cancel) {
  std::vector<float> view(sides.slot.size());
  const float most = std::max(1e-6f, (scene.bounds.max - scene.bounds.min).length());
  parallelFor(view.size(), 256, threads, cancel, [&](size_t begin, size_t end) {
    std::vector<trace::Hit> hits;
    for (uint32_t side = uint32_t(begin); side < end; ++side) {
      const auto rays = cosineRays(scene.mesh, atlas, sides, {&side, 1}, kViewRays, seed, kViewStream + side);
      hits.resize(rays.size());
      tracer.closest(rays, hits);
      float sum = 0;
      for (const auto& hit : hits) sum += 1.0f / std::clamp(hit.triangle == kNone ? most : hit.t, 1e-4f * most, most);
      view[side] = hits.empty() ? 0.0f : float(hits.size()) / sum;
    }
  });
  std::vector<float> sorted = view;
  if (sorted.empty()) return view;
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(sorted.size() / 2), sorted.end());
  const float median = std::max(1e-6f * most, sorted[sorted.size() / 2]);
  for (float& v : view) v = std::clamp(v / median, kLeastSpacing, 1.0f);
  return view;
}

/// Groups of about the same extent, split into fine clusters of about the same smaller extent.
ClusterList partitionSides(const atlas::Atlas& atlas, const Sides& sides, std::span<const float> exposed, std::span<const float> spacing,
                           const EntryOptions& options) {
  std::vector<SurfaceElement> elements;
  std::vector<uint32_t> element_side;
  for (uint32_t side = 0; side < sides.slot.size(); ++side) {
    const auto& slot = atlas.slots[sides.slot[side]];
    if (exposed[side] <= 0) continue;
    elements.push_back({slot.position, sides.isBack(side) ? -slot.normal : slot.normal, std::sqrt(spacing[side])});
    element_side.push_back(side);
  }
  const Partition groups = partitionByCount(elements, options.groups, kNormalExtent, elements.size());
  const float fine_ratio = std::sqrt(float(std::max(1u, options.groups)) / float(std::max(options.clusters, options.groups)));

  // The fine clusters split each group on its own, at an extent common to all: smaller than the groups' by the square root of the ratio of counts.
  std::vector<std::vector<SurfaceElement>> members(groups.count());
  float group_extent = 0;
  for (uint32_t g = 0; g < groups.count(); ++g) {
    Box3 box;
    for (uint32_t i = groups.first[g]; i < groups.first[g + 1]; ++i) {
      members[g].push_back(elements[groups.order[i]]);
      members[g].back().spacing = spacing[element_side[groups.order[i]]];
      box.extendBy(members[g].back().position);
    }
    group_extent = std::max(group_extent, maxComponent(box.size()));
  }
  float fine = group_extent * fine_ratio * 0.25f, coarse = group_extent * fine_ratio * 4.0f;
  std::vector<Partition> split(groups.count());
  for (int step = 0; step < 10 && groups.count() > 0; ++step) {
    const float extent = std::sqrt(fine * coarse);
    size_t total = 0;
    for (uint32_t g = 0; g < groups.count(); ++g) {
      split[g] = partitionByExtent(members[g], extent, kNormalExtent, members[g].size());
      total += split[g].count();
    }
    (total > options.clusters ? fine : coarse) = extent;
  }

  ClusterList list;
  std::vector<uint32_t> cluster;
  for (uint32_t g = 0; g < groups.count(); ++g)
    for (uint32_t c = 0; c < split[g].count(); ++c) {
      cluster.clear();
      for (uint32_t i = split[g].first[c]; i < split[g].first[c + 1]; ++i)
        cluster.push_back(element_side[groups.order[groups.first[g] + split[g].order[i]]]);
      list.append(cluster, g);
    }
  return list;
}

EntryClusters numberClusters(const atlas::Atlas& atlas, const Sides& sides, std::span<const float> exposed, ClusterList list) {
  EntryClusters result;
  result.exposed.assign(exposed.begin(), exposed.end());
  result.cluster_count = uint32_t(list.group_of_cluster.size());
  result.group_count = list.group_of_cluster.empty() ? 0 : list.group_of_cluster.back() + 1;
  result.cluster_of_side.assign(sides.slot.size(), kNone);
  result.area.assign(result.cluster_count + result.group_count, 0.0f);
  result.group_first_cluster.assign(result.group_count + 1, result.cluster_count);
  for (uint32_t c = result.cluster_count; c-- > 0;) {
    result.group_first_cluster[list.group_of_cluster[c]] = c;
    for (const uint32_t side : list.sides(c)) {
      result.cluster_of_side[side] = c;
      result.area[c] += atlas.slots[sides.slot[side]].area * exposed[side];
    }
    result.area[result.cluster_count + list.group_of_cluster[c]] += result.area[c];
  }
  result.cluster_first_side = std::move(list.cluster_first_side);
  result.cluster_side = std::move(list.cluster_side);
  result.group_of_cluster = std::move(list.group_of_cluster);
  return result;
}

/// What a cluster sees: shares of the groups met by rays. Two samples, whose common share says how much is lost to noise.
using Sample = std::vector<std::pair<uint32_t, float>>;
struct Surroundings {
  Sample sample[2];
  float own_overlap = 0;
};

float overlap(const Sample& a, const Sample& b) {
  float sum = 0;
  for (auto i = a.begin(), j = b.begin(); i != a.end() && j != b.end();) {
    if (i->first == j->first) sum += std::min((i++)->second, (j++)->second);
    else if (i->first < j->first) ++i;
    else ++j;
  }
  return sum;
}

/// About 1 where both see the same, 0 where they have nothing in common; 1 also where rays met nothing.
float likeness(const Surroundings& a, const Surroundings& b) {
  const float own = std::sqrt(a.own_overlap * b.own_overlap);
  return own > 0 ? 0.5f * (overlap(a.sample[0], b.sample[1]) + overlap(a.sample[1], b.sample[0])) / own : 1.0f;
}

/// Cuts groups where their clusters do not see the same surroundings: on both sides of a wall, in a sealed pocket, above and below a shelf. Light
/// that is averaged over such a group would pass through the wall.
ClusterList splitByVisibility(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides,
                              const EntryClusters& clusters, uint64_t seed, int threads, const CancelFlag* cancel) {
  const Gatherer gatherer(scene, atlas, tracer, sides, clusters, seed);
  std::vector<Surroundings> surroundings(clusters.cluster_count);
  const auto lookAround = [&](uint32_t c) {
    for (uint64_t half = 0; half < 2; ++half) {
      Sample& sample = surroundings[c].sample[half];
      uint32_t seen = 0;
      for (const auto& [cluster, count] : gatherer.met(clusters.sidesOf(c), kSurroundingRays, kSurroundingStream + 2 * c + half)) {
        const uint32_t group = clusters.group_of_cluster[cluster];
        if (sample.empty() || sample.back().first != group) sample.emplace_back(group, 0.0f);
        sample.back().second += float(count);
        seen += count;
      }
      for (auto& [group, share] : sample) share /= float(seen);
    }
    surroundings[c].own_overlap = overlap(surroundings[c].sample[0], surroundings[c].sample[1]);
  };
  parallelFor(clusters.cluster_count, 64, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t c = begin; c < end; ++c) lookAround(uint32_t(c));
  });
  ClusterList list;
  uint32_t group_count = 0;
  for (uint32_t g = 0; g < clusters.group_count; ++g) {
    std::vector<uint32_t> rest(clusters.group_first_cluster[g + 1] - clusters.group_first_cluster[g]);
    std::iota(rest.begin(), rest.end(), clusters.group_first_cluster[g]);
    while (!rest.empty()) {  // one connected part after another
      std::vector<uint32_t> part = {rest.front()};
      rest.erase(rest.begin());
      for (size_t i = 0; i < part.size(); ++i) {
        const auto joined = std::stable_partition(rest.begin(), rest.end(), [&](uint32_t c) {
          return likeness(surroundings[part[i]], surroundings[c]) < kSameSurroundings;
        });
        part.insert(part.end(), joined, rest.end());
        rest.erase(joined, rest.end());
      }
      std::sort(part.begin(), part.end());
      for (const uint32_t c : part) list.append(clusters.sidesOf(c), group_count);
      ++group_count;
    }
  }
  return list;
}

/// Puts groups, and the clusters within each, in the order of a tree that keeps near what is near and alike in orientation, and gives the tree. Where all clusters under a node of
/// one group are `unreached`, they become one.
class TreeOrder {
 public:
  TreeOrder(const atlas::Atlas& atlas, const Sides& sides, const EntryClusters& clusters, std::span<const char> unreached) : clusters_(clusters), unreached_(unreached) {
    std::vector<Item> group_items(clusters.group_count);
    items_.resize(clusters.cluster_count);
    double area = 0;
    for (uint32_t c = 0; c < clusters.cluster_count; ++c) {
      Item& item = items_[c];
      for (const uint32_t side : clusters.sidesOf(c)) {
        const auto& slot = atlas.slots[sides.slot[side]];
        const float weight = slot.area * clusters.exposed[side];
        item.position += slot.position * weight;
        item.normal += (sides.isBack(side) ? -slot.normal : slot.normal) * weight;
      }
      Item& group = group_items[clusters.group_of_cluster[c]];
      group.position += item.position, group.normal += item.normal;
      area += clusters.area[c];
      item = {item.position / clusters.area[c], item.normal.normalized(), c};
    }
    for (uint32_t g = 0; g < clusters.group_count; ++g)
      group_items[g] = {group_items[g].position / clusters.area[clusters.cluster_count + g], group_items[g].normal.normalized(), g};
    // A turn by a right angle parts two pieces of surface like this distance: some widths of a group.
    length_per_normal_ = 2 * float(std::sqrt(area / std::max(1u, clusters.group_count)));
    if (!group_items.empty()) build(group_items, true);
  }
  ClusterList list;
  WaveletTree tree;
  uint32_t merged = 0;

 private:
  struct Item {
    Vec3 position{0, 0, 0}, normal{0, 0, 0};
    uint32_t index = 0;
  };

  double build(std::span<Item> items, bool of_groups) {
    if (!of_groups && (items.size() == 1 || std::all_of(items.begin(), items.end(), [&](const Item& item) { return unreached_[item.index]; }))) {
      std::vector<uint32_t> sides;
      double area = 0;
      for (const Item& item : items) {
        const auto more = clusters_.sidesOf(item.index);
        sides.insert(sides.end(), more.begin(), more.end());
        area += clusters_.area[item.index];
      }
      list.append(sides, group_);
      merged += uint32_t(items.size() - 1);
      return area;
    }
    if (items.size() == 1) {
      group_ = next_group_++;
      const uint32_t first = clusters_.group_first_cluster[items[0].index], end = clusters_.group_first_cluster[items[0].index + 1];
      return build(std::span(items_).subspan(first, end - first), false);
    }
    const size_t middle = split(items), node = tree.first_leaves.size();
    const size_t leaves_before = list.group_of_cluster.size();
    tree.first_leaves.push_back(0);
    tree.first_share.push_back(0);
    const double first_area = build(items.first(middle), of_groups);
    tree.first_leaves[node] = uint32_t(list.group_of_cluster.size() - leaves_before);
    const double area = first_area + build(items.subspan(middle), of_groups);
    tree.first_share[node] = uint16_t(std::clamp(std::round(65536.0 * first_area / area), 1.0, 65535.0));
    return area;
  }

  /// Halves the longest extent; where that leaves hardly anything on one side, the number of items.
  size_t split(std::span<Item> items) const {
    Box3 place, direction;
    for (const Item& item : items) place.extendBy(item.position), direction.extendBy(item.normal * length_per_normal_);
    const int place_axis = place.majorAxis(), direction_axis = direction.majorAxis();
    const bool by_place = place.size()[place_axis] >= direction.size()[direction_axis];
    const int axis = by_place ? place_axis : direction_axis;
    const auto key = [&](const Item& item) { return by_place ? item.position[axis] : item.normal[axis] * length_per_normal_; };
    std::stable_sort(items.begin(), items.end(), [&](const Item& a, const Item& b) { return key(a) < key(b); });
    const float at = 0.5f * (key(items.front()) + key(items.back()));
    const size_t middle = size_t(std::partition_point(items.begin(), items.end(), [&](const Item& item) { return key(item) <= at; }) - items.begin());
    const size_t least = items.size() / 32 + 1;
    return middle < least || middle > items.size() - least ? items.size() / 2 : middle;
  }

  const EntryClusters& clusters_;
  const std::span<const char> unreached_;
  std::vector<Item> items_;
  float length_per_normal_ = 0;
  uint32_t group_ = 0, next_group_ = 0;
};

/// Moves the entries of merged clusters to the nearest of the places that light was seen not to reach: beside them it may.
void keepInTheDark(const EntryClusters& single, std::span<const char> unreached, EntryClusters& merged) {
  for (uint32_t c = 0; c < merged.cluster_count; ++c) {
    if (!unreached[single.cluster_of_side[merged.sidesOf(c).front()]]) continue;
    for (uint32_t i = merged.entries.cluster_first_entry[c]; i < merged.entries.cluster_first_entry[c + 1]; ++i) {
      const Vec3 position = merged.entries.position[i];
      float distance2 = std::numeric_limits<float>::infinity();
      for (const uint32_t side : merged.sidesOf(c)) {
        const uint32_t from = single.cluster_of_side[side];
        for (uint32_t k = single.entries.cluster_first_entry[from]; k < single.entries.cluster_first_entry[from + 1]; ++k) {
          if ((single.entries.position[k] - position).length2() >= distance2) continue;
          distance2 = (single.entries.position[k] - position).length2();
          merged.entries.position[i] = single.entries.position[k], merged.entries.normal[i] = single.entries.normal[k];
        }
      }
    }
  }
}

}  // namespace

EntryClusters makeEntries(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const EntryOptions& options,
                          std::span<const PriorLight> likely_lights, uint64_t seed, int threads, const CancelFlag* cancel) {
  const Sides sides = surfaceSides(atlas);
  const std::vector<float> exposed = exposedShare(scene, atlas, tracer, sides, seed, threads, cancel);
  const std::vector<float> spacing = options.denser_where_near ? entrySpacing(scene, atlas, tracer, sides, seed, threads, cancel)
                                                               : std::vector<float>(sides.slot.size(), 1.0f);
  EntryClusters result = numberClusters(atlas, sides, exposed, partitionSides(atlas, sides, exposed, spacing, options));
  if (options.split_by_visibility)
    result = numberClusters(atlas, sides, exposed, splitByVisibility(scene, atlas, tracer, sides, result, seed, threads, cancel));
  const auto entriesOf = [&](const EntryClusters& clusters) {
    PrmEntries entries;
    entries.cluster_first_entry.push_back(0);
    for (uint32_t c = 0; c < clusters.cluster_count; ++c) appendEntries(scene.mesh, atlas, sides, exposed, clusters.sidesOf(c), options.points_per_cluster, entries);
    return entries;
  };
  std::vector<char> unreached(result.cluster_count, 0);
  if (!likely_lights.empty()) {
    result.entries = entriesOf(result);
    unreached = unreachedClusters(result.entries, tracer, likely_lights, threads, cancel);
  }
  TreeOrder ordered(atlas, sides, result, unreached);
  const EntryClusters single = std::exchange(result, numberClusters(atlas, sides, exposed, std::move(ordered.list)));
  result.tree = std::move(ordered.tree);
  result.merged_clusters = ordered.merged;
  result.entries = entriesOf(result);
  if (ordered.merged > 0) keepInTheDark(single, unreached, result);
  for (uint32_t g = 0; g < result.group_count; ++g) appendEntries(scene.mesh, atlas, sides, exposed, result.sidesOfGroup(g), options.points_per_group, result.entries);
  return result;
}

Bytes toBytes(const EntryClusters& clusters) {
  const std::array counts{clusters.cluster_count, clusters.group_count, clusters.merged_clusters};
  ByteWriter writer;
  writer.array(std::span<const uint32_t>(counts));
  for (const auto* indices : {&clusters.cluster_of_side, &clusters.group_of_cluster, &clusters.cluster_first_side, &clusters.cluster_side,
                              &clusters.group_first_cluster, &clusters.entries.cluster_first_entry, &clusters.tree.first_leaves})
    writer.array(*indices);
  writer.array(clusters.tree.first_share);
  writer.array(clusters.exposed);
  writer.array(clusters.area);
  writer.array(clusters.entries.position);
  writer.array(clusters.entries.normal);
  writer.array(clusters.entries.half_u);
  writer.array(clusters.entries.half_v);
  writer.array(clusters.entries.weight);
  return writer.take();
}

EntryClusters readEntries(ByteView bytes) {
  EntryClusters clusters;
  ByteReader reader(bytes);
  const auto counts = reader.array<uint32_t>();
  if (counts.size() != 3) throw std::runtime_error("a task result is damaged");
  clusters.cluster_count = counts[0], clusters.group_count = counts[1], clusters.merged_clusters = counts[2];
  for (auto* indices : {&clusters.cluster_of_side, &clusters.group_of_cluster, &clusters.cluster_first_side, &clusters.cluster_side,
                        &clusters.group_first_cluster, &clusters.entries.cluster_first_entry, &clusters.tree.first_leaves})
    *indices = reader.array<uint32_t>();
  clusters.tree.first_share = reader.array<uint16_t>();
  clusters.exposed = reader.array<float>();
  clusters.area = reader.array<float>();
  clusters.entries.position = reader.array<Vec3>();
  clusters.entries.normal = reader.array<Vec3>();
  clusters.entries.half_u = reader.array<Vec3>();
  clusters.entries.half_v = reader.array<Vec3>();
  clusters.entries.weight = reader.array<float>();
  return clusters;
}

}  // namespace lightwell::transport
