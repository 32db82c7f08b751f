#include "precompute/transport/radiosity/patches.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace lightwell::transport {
namespace {

/// What the sides of one patch have in common.
struct PatchKey {
  uint32_t chart, row, column, material;
  bool back;
  auto tied() const { return std::tie(back, chart, row, column, material); }
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
  sorted.texels_per_side = patches.texels_per_side;
  sorted.area = permuted(patches.area, order);
  sorted.position = permuted(patches.position, order);
  sorted.normal = permuted(patches.normal, order);
  sorted.material = permuted(patches.material, order);
  sorted.albedo_rgb = permuted(patches.albedo_rgb, order);
  sorted.emitted_radiance_rgb = permuted(patches.emitted_radiance_rgb, order);
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

Patches makePatches(const scene::Scene& scene, const atlas::Atlas& atlas, const Sides& sides, uint32_t texels_per_side) {
  std::vector<std::pair<PatchKey, uint32_t>> keyed;
  for (uint32_t side = 0; side < sides.slot.size(); ++side) {
    const atlas::Slot& slot = atlas.slots[sides.slot[side]];
    if (atlas.source[slot.texel] != slot.texel || slot.area <= 0) continue;
    const uint32_t x = slot.texel % uint32_t(atlas.width), y = slot.texel / uint32_t(atlas.width);
    keyed.push_back({{slot.chart, y / texels_per_side, x / texels_per_side, materialOf(scene.mesh, atlas, slot), sides.isBack(side)}, side});
  }
  std::stable_sort(keyed.begin(), keyed.end(), [](const auto& a, const auto& b) { return a.first < b.first; });

  Patches patches;
  patches.texels_per_side = texels_per_side;
  patches.first_side.push_back(0);
  for (size_t begin = 0, end; begin < keyed.size(); begin = end) {
    for (end = begin; end < keyed.size() && keyed[end].first == keyed[begin].first;) ++end;
    double area = 0;
    Vec3d position(0.0), normal(0.0), albedo(0.0), emitted(0.0);
    for (size_t i = begin; i < end; ++i) {
      const atlas::Slot& slot = atlas.slots[sides.slot[keyed[i].second]];
      const double weight = slot.area;
      area += weight;
      position += Vec3d(slot.position) * weight;
      normal += Vec3d(slot.normal) * (keyed[i].first.back ? -weight : weight);
      albedo += Vec3d(slot.albedo_rgb) * weight;
      emitted += Vec3d(slot.emitted_radiance_rgb) * weight;
      patches.side.push_back(keyed[i].second);
    }
    patches.first_side.push_back(uint32_t(patches.side.size()));
    patches.area.push_back(float(area));
    patches.position.push_back(Vec3(position / area));
    patches.normal.push_back(normal.length() > 0 ? Vec3(normal.normalized()) : atlas.slots[sides.slot[keyed[begin].second]].normal);
    patches.material.push_back(keyed[begin].first.material);
    patches.albedo_rgb.push_back(Rgb(albedo / area));
    patches.emitted_radiance_rgb.push_back(Rgb(emitted / area));
  }
  patches.patch_of_side.assign(sides.slot.size(), kNone);

  std::vector<uint32_t> order(patches.count());
  std::iota(order.begin(), order.end(), 0u);
  sortInSpace(patches, order, 0, order.size(), 1);
  return inOrder(patches, order);
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
