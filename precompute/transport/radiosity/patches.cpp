#include "precompute/transport/radiosity/patches.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include "precompute/core/parallel.h"
#include "precompute/transport/side_rays.h"

namespace lightwell::transport {
namespace {

constexpr uint32_t kNearRays = 64;
constexpr float kNearDistance = 2.0f;  // of the square's diagonal
constexpr double kLeastArea = 1e-6;    // of the mean texel: exchanges with less would be lost to rounding
constexpr uint64_t kNearStream = 6ull << 40;

/// What the sides of one patch have in common.
struct PatchKey {
  uint32_t chart, row, column, material, zone;
  bool back;
  auto tied() const { return std::tie(back, chart, material, row, column, zone); }
  bool operator<(const PatchKey& other) const { return tied() < other.tied(); }
  bool operator==(const PatchKey& other) const { return tied() == other.tied(); }
};

/// The material that covers most of a slot.
uint32_t materialOf(const scene::Mesh& mesh, const atlas::Atlas& atlas, const atlas::Slot& slot) {
  std::vector<std::pair<uint32_t, double>> share;
  for (uint32_t p = slot.first_patch; p < slot.first_patch + slot.patch_count; ++p) {
    const uint32_t material = mesh.triangle_material[atlas.patches[p].triangle];
    auto found = std::find_if(share.begin(), share.end(), [&](const auto& s) { return s.first == material; });
    if (found == share.end()) found = share.insert(share.end(), {material, 0.0});
    found->second += atlas.patches[p].area;
  }
  return std::max_element(share.begin(), share.end(), [](const auto& a, const auto& b) { return a.second < b.second; })->first;
}

/// What a texel's area counts at least.
double leastArea(const atlas::Atlas& atlas) {
  double total = 0;
  for (const auto& slot : atlas.slots) total += slot.area;
  return kLeastArea * total / double(std::max<size_t>(1, atlas.slots.size()));
}

/// The sides that become one patch.
struct Square {
  PatchKey key;
  uint32_t texels;
  std::vector<uint32_t> sides;
};

/// The squares of all sides, quartered where things are near.
class Squares {
 public:
  Squares(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, std::span<const float> exposed,
          const PatchOptions& options)
      : scene_(scene), atlas_(atlas), tracer_(tracer), sides_(sides), options_(options) {
    material_.reserve(atlas.slots.size());
    for (const auto& slot : atlas.slots) material_.push_back(materialOf(scene.mesh, atlas, slot));
    const auto zones = PortalZones(scene).ofSides(atlas, sides, options.coarsest);
    std::map<PortalZone, uint32_t> zone_number;
    for (const PortalZone& zone : zones) zone_.push_back(zone_number.try_emplace(zone, uint32_t(zone_number.size())).first->second);
    std::vector<uint32_t> used;
    for (uint32_t side = 0; side < sides.slot.size(); ++side) {
      const bool divided = !zones.empty() && zones[side].kind == PortalZone::divided;
      if (atlas.slots[sides.slot[side]].area > 0 && exposed[side] > 0 && !divided) used.push_back(side);
    }
    std::vector<Square> open = cut(used, options.coarsest);
    while (!open.empty()) {
      std::vector<float> near(open.size(), 0.0f);
      parallelFor(open.size(), 64, options.threads, options.cancel, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i)
          if (open[i].texels > options.finest) near[i] = nearShare(open[i]);
      });
      std::vector<uint32_t> order(open.size());
      std::iota(order.begin(), order.end(), 0u);
      std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return near[a] > near[b]; });
      // Every size of square may use half of what is left, so that the smallest get some.
      size_t left = options.most > list_.size() + open.size() ? (options.most - list_.size() - open.size()) / (open[0].texels > 2 * options.finest ? 2 : 1) : 0;
      std::vector<Square> quarters;
      for (const uint32_t i : order) {
        const size_t more = std::min<size_t>(3, open[i].sides.size() - 1);
        if (near[i] <= options.near_share || more > left || more == 0) {
          list_.push_back(std::move(open[i]));
          continue;
        }
        left -= more;
        for (Square& quarter : cut(open[i].sides, open[i].texels / 2)) quarters.push_back(std::move(quarter));
      }
      open = std::move(quarters);
    }
  }
  const std::vector<Square>& list() const { return list_; }

 private:
  std::vector<Square> cut(std::span<const uint32_t> sides, uint32_t texels) const {
    std::vector<std::pair<PatchKey, uint32_t>> keyed;
    for (const uint32_t side : sides) {
      const atlas::Slot& slot = atlas_.slots[sides_.slot[side]];
      const uint32_t x = slot.texel % uint32_t(atlas_.width), y = slot.texel / uint32_t(atlas_.width);
      keyed.push_back({{slot.chart, y / texels, x / texels, material_[sides_.slot[side]], zone_.empty() ? 0 : zone_[side], sides_.isBack(side)}, side});
    }
    std::stable_sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Square> squares;
    for (const auto& [key, side] : keyed) {
      if (squares.empty() || !(squares.back().key == key)) squares.push_back({key, texels, {}});
      squares.back().sides.push_back(side);
    }
    return squares;
  }

  /// The share of what a square sees that is nearer than about twice its extent.
  float nearShare(const Square& square) const {
    Box3 box;
    for (const uint32_t side : square.sides) {
      const atlas::Slot& slot = atlas_.slots[sides_.slot[side]];
      for (uint32_t p = slot.first_patch; p < slot.first_patch + slot.patch_count; ++p)
        for (const Vec2& corner : atlas_.patches[p].corner)
          box.extendBy(atlas::surfacePoint(scene_.mesh, atlas_.patches[p].triangle, corner.x, corner.y).position);
    }
    const auto rays = cosineRays(scene_.mesh, atlas_, sides_, square.sides, kNearRays, options_.seed, kNearStream + square.sides[0] * 64ull + square.texels);
    std::vector<trace::Hit> hits(rays.size());
    tracer_.closest(rays, hits);
    uint32_t near = 0;
    for (const auto& hit : hits) near += hit.triangle != kNone && hit.t < kNearDistance * box.size().length();
    return float(near) / kNearRays;
  }

  const scene::Scene& scene_;
  const atlas::Atlas& atlas_;
  const trace::Tracer& tracer_;
  const Sides& sides_;
  const PatchOptions& options_;
  std::vector<uint32_t> material_;  // per slot
  std::vector<uint32_t> zone_;      // per side; empty without portals
  std::vector<Square> list_;
};

/// Halves [begin, end) of `order` at the median of the longest axis of (position, normal), recursively, until `leaf` are left: neighbours in the
/// order are neighbours in space that face the same way.
void sortInSpace(const Patches& patches, std::vector<uint32_t>& order, size_t begin, size_t end, size_t leaf) {
  if (end - begin <= leaf) return;
  Box3 positions, normals;
  for (size_t i = begin; i < end; ++i) {
    positions.extendBy(patches.position[order[i]]);
    normals.extendBy(patches.normal[order[i]]);
  }
  const float normal_extent = 0.5f * positions.size().length();  // what a difference of one in a unit normal is worth
  const auto coordinate = [&](uint32_t patch, int axis) {
    return axis < 3 ? patches.position[patch][axis] : patches.normal[patch][axis - 3] * normal_extent;
  };
  int longest = 0;
  float extent = -1;
  for (int axis = 0; axis < 6; ++axis) {
    const float size = axis < 3 ? positions.size()[axis] : normals.size()[axis - 3] * normal_extent;
    if (size > extent) extent = size, longest = axis;
  }
  // Blocks of equal powers of two, so that nodes of every level are blocks of the same order.
  size_t half = leaf;
  while (half * 2 < end - begin) half *= 2;
  const auto middle = order.begin() + std::ptrdiff_t(begin + half);
  std::nth_element(order.begin() + std::ptrdiff_t(begin), middle, order.begin() + std::ptrdiff_t(end), [&](uint32_t a, uint32_t b) {
    const float at_a = coordinate(a, longest), at_b = coordinate(b, longest);
    return at_a != at_b ? at_a < at_b : a < b;
  });
  sortInSpace(patches, order, begin, begin + half, leaf);
  sortInSpace(patches, order, begin + half, end, leaf);
}

template <class T>
std::vector<T> permuted(const std::vector<T>& values, const std::vector<uint32_t>& order) {
  std::vector<T> result;
  result.reserve(order.size());
  for (const uint32_t i : order) result.push_back(values[i]);
  return result;
}

/// The patches renumbered: the new i-th is the old order[i].
Patches inOrder(const Patches& patches, const std::vector<uint32_t>& order) {
  Patches sorted;
  sorted.texels_per_side = permuted(patches.texels_per_side, order);
  sorted.area = permuted(patches.area, order);
  sorted.exposed_share = permuted(patches.exposed_share, order);
  sorted.position = permuted(patches.position, order);
  sorted.normal = permuted(patches.normal, order);
  sorted.material = permuted(patches.material, order);
  sorted.patch_of_side.assign(patches.patch_of_side.size(), kNone);
  sorted.first_side.push_back(0);
  for (uint32_t i = 0; i < order.size(); ++i) {
    for (const uint32_t side : patches.sidesOf(order[i])) {
      sorted.side.push_back(side);
      sorted.patch_of_side[side] = i;
    }
    sorted.first_side.push_back(uint32_t(sorted.side.size()));
  }
  return sorted;
}

}  // namespace

Patches makePatches(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, std::span<const float> exposed,
                    const PatchOptions& options) {
  const Squares squares(scene, atlas, tracer, sides, exposed, options);
  Patches patches;
  patches.first_side.push_back(0);
  const double least_area = leastArea(atlas);
  for (const Square& square : squares.list()) {
    double area = 0, whole_area = 0;
    Vec3d position(0.0), normal(0.0);
    for (const uint32_t side : square.sides) {
      const atlas::Slot& slot = atlas.slots[sides.slot[side]];
      const double slot_area = std::max(double(slot.area), least_area);
      const double weight = slot_area * exposed[side];
      whole_area += slot_area;
      area += weight;
      position += Vec3d(slot.position) * weight;
      normal += Vec3d(slot.normal) * (square.key.back ? -weight : weight);
      patches.side.push_back(side);
    }
    patches.first_side.push_back(uint32_t(patches.side.size()));
    patches.texels_per_side.push_back(uint8_t(square.texels));
    patches.area.push_back(float(area));
    patches.exposed_share.push_back(float(area / whole_area));
    patches.position.push_back(Vec3(position / area));
    const Vec3 any_normal = atlas.slots[sides.slot[square.sides[0]]].normal;
    patches.normal.push_back(normal.length() > 0 ? Vec3(normal.normalized()) : square.key.back ? -any_normal : any_normal);
    patches.material.push_back(square.key.material);
  }
  patches.patch_of_side.assign(sides.slot.size(), kNone);

  std::vector<uint32_t> order(patches.count());
  std::iota(order.begin(), order.end(), 0u);
  sortInSpace(patches, order, 0, order.size(), 1);
  return inOrder(patches, order);
}

void colorPatches(const atlas::Atlas& atlas, const Sides& sides, std::span<const float> exposed, Patches& patches) {
  patches.albedo_rgb.clear();
  patches.emitted_radiance_rgb.clear();
  const double least_area = leastArea(atlas);
  for (uint32_t patch = 0; patch < patches.count(); ++patch) {
    Vec3d albedo(0.0), emitted(0.0);
    double total = 0;
    for (const uint32_t side : patches.sidesOf(patch)) {
      const atlas::Slot& slot = atlas.slots[sides.slot[side]];
      const double weight = std::max(double(slot.area), least_area) * exposed[side];
      albedo += Vec3d(slot.albedo_rgb) * weight;
      emitted += Vec3d(slot.emitted_radiance_rgb) * weight;
      total += weight;
    }
    patches.albedo_rgb.push_back(Rgb(albedo / total));
    patches.emitted_radiance_rgb.push_back(Rgb(emitted / total));
  }
}

void zonePatches(const scene::Scene& scene, const atlas::Atlas& atlas, const Sides& sides, const PatchOptions& options, Patches& patches) {
  const auto zones = PortalZones(scene).ofSides(atlas, sides, options.coarsest);
  patches.zone.clear();
  for (uint32_t patch = 0; !zones.empty() && patch < patches.count(); ++patch) patches.zone.push_back(zones[patches.sidesOf(patch)[0]]);
}

PatchTree makePatchTree(const Patches& patches) {
  PatchTree tree;
  tree.level_first = {0, patches.count()};
  for (uint32_t i = 0; i < patches.count(); ++i) {
    tree.first_patch.push_back(i);
    tree.end_patch.push_back(i + 1);
    tree.area.push_back(patches.area[i]);
  }
  while (tree.level_first.back() - tree.level_first[tree.level_first.size() - 2] > PatchTree::kBranching) {
    const uint32_t begin = tree.level_first[tree.level_first.size() - 2], end = tree.level_first.back();
    for (uint32_t child = begin; child < end; child += PatchTree::kBranching) {
      const uint32_t last = std::min(child + PatchTree::kBranching, end);
      tree.first_child.push_back(child);
      tree.first_patch.push_back(tree.first_patch[child]);
      tree.end_patch.push_back(tree.end_patch[last - 1]);
      double area = 0;
      for (uint32_t i = child; i < last; ++i) area += tree.area[i];
      tree.area.push_back(float(area));
    }
    tree.level_first.push_back(uint32_t(tree.area.size()));
  }
  if (tree.level_first.size() > 2) tree.first_child.push_back(tree.level_first[tree.level_first.size() - 2]);
  return tree;
}

}  // namespace lightwell::transport
