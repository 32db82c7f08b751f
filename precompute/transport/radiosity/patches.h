// Patches: the pieces of surface between which radiosity is exchanged, and the tree of ever larger nodes over them.
//
// A patch gathers the texels' sides that lie in one square of the light map (smaller ones where things are near), in one chart and of one material, so that it never reaches across a
// wall, an edge of the unwrap or a change of paint. Its area is the exact clipped area of what lies in those texels, without what other things cover.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/radiosity/portal_zones.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

struct Patches {
  std::vector<uint8_t> texels_per_side;    // of a patch's square in the light map: 1, 2, 4 …
  std::vector<uint32_t> first_side, side;  // the sides of patch i: side[first_side[i] … first_side[i + 1])
  std::vector<uint32_t> patch_of_side;     // kNone for sides mostly inside or behind other surfaces: what little of them is seen absorbs
  std::vector<float> area;                 // exposed, internal units²
  std::vector<float> exposed_share;        // of the whole area, in (0, 1]
  std::vector<Vec3> position, normal;      // area-weighted means; normals unit
  std::vector<uint32_t> material;          // the one that covers most of it
  std::vector<Rgb> albedo_rgb, emitted_radiance_rgb;  // area-weighted; set by colorPatches
  std::vector<PortalZone> zone;            // set by zonePatches; empty in scenes without portals

  uint32_t count() const { return uint32_t(area.size()); }
  std::span<const uint32_t> sidesOf(uint32_t patch) const {
    return std::span<const uint32_t>(side).subspan(first_side[patch], first_side[patch + 1] - first_side[patch]);
  }
};

struct PatchOptions {
  uint32_t coarsest = 2;      // texels along a square where nothing is near: a power of two, 1 to 64
  uint32_t finest = 1;        // where things are as near as a square is wide: a power of two, at most the coarsest
  float near_share = 0.1f;    // a square is quartered where more than this share of what it sees is nearer than twice its own extent
  uint32_t most = 24000;      // patches, about: where they do not suffice, the squares that see most things near come first
  uint64_t seed = 1;
  int threads = 0;
  const CancelFlag* cancel = nullptr;
};

/// In the order of PatchTree. `exposed` is exposedShare of the sides. Light changes within the distance to what it is reflected by, so patches are small in corners
/// and along lines of contact, and large in the open.
Patches makePatches(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, std::span<const float> exposed,
                    const PatchOptions& options);

/// Sets the colours, which makePatches leaves empty: shapes do not depend on them.
void colorPatches(const atlas::Atlas& atlas, const Sides& sides, std::span<const float> exposed, Patches& patches);
/// Sets the zones, as makePatches has found them with the same `options`.
void zonePatches(const scene::Scene& scene, const atlas::Atlas& atlas, const Sides& sides, const PatchOptions& options, Patches& patches);

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
