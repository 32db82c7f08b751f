// Patches: the pieces of surface between which radiosity is exchanged, and the tree of ever larger nodes over them.
//
// A patch gathers the texels' sides that lie in one square of the light map, in one chart and of one material, so that it never reaches across a
// wall, an edge of the unwrap or a change of paint. Its area is the exact clipped area of what lies in those texels.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "precompute/transport/sides.h"

namespace lightwell::transport {

struct Patches {
  uint32_t texels_per_side = 1;  // of a patch's square in the light map
  std::vector<uint32_t> first_side, side;  // the sides of patch i: side[first_side[i] … first_side[i + 1])
  std::vector<uint32_t> patch_of_side;     // kNone for sides mostly inside or behind other surfaces: what little of them is seen absorbs
  std::vector<float> area;                 // internal units²
  std::vector<Vec3> position, normal;      // area-weighted means; normals unit
  std::vector<uint32_t> material;          // the one that covers most of it
  std::vector<Rgb> albedo_rgb, emitted_radiance_rgb;  // area-weighted

  uint32_t count() const { return uint32_t(area.size()); }
  std::span<const uint32_t> sidesOf(uint32_t patch) const {
    return std::span<const uint32_t>(side).subspan(first_side[patch], first_side[patch + 1] - first_side[patch]);
  }
};

/// Patches of squares of `texels_per_side` (≥ 1) texels, in the order of PatchTree.
Patches makePatches(const scene::Scene& scene, const atlas::Atlas& atlas, const Sides& sides, uint32_t texels_per_side);

/// Nodes over patches, level by level: nodes [0, patches) are the patches, then come nodes of about eight of them each, then nodes of those. The children of
/// a node are consecutive, and so are all patches below it.
struct PatchTree {
  static constexpr uint32_t kBranching = 8;
  std::vector<uint32_t> level_first;  // levels + 1; level 0 are the patches
  std::vector<uint32_t> first_child;  // per node of level ≥ 1 and one more: its children are nodes [first_child[i], first_child[i + 1]), i = node − patches
  std::vector<uint32_t> first_patch, end_patch;  // per node: the patches below
  std::vector<float> area;                       // per node, internal units²

  uint32_t nodeCount() const { return level_first.back(); }
  uint32_t levelCount() const { return uint32_t(level_first.size()) - 1; }
};

PatchTree makePatchTree(const Patches& patches);

}  // namespace lightwell::transport
