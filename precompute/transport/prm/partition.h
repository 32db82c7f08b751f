// Compact pieces of the surface: texels grouped by position and orientation. Used for entry clusters and for blocks of texels.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// One element to be grouped: a texel's side.
struct SurfaceElement {
  Vec3 position;  // internal units
  Vec3 normal;    // unit
  float spacing = 1;  // in (0, 1]: of the extent that a group may have, what one with this element may
};

/// Groups of elements: `order` lists element indices group by group; group g is [first[g], first[g + 1]) of it.
struct Partition {
  std::vector<uint32_t> order, first;
  uint32_t count() const { return uint32_t(first.size()) - 1; }
};

/// Bisects at the middle of the longest axis of (position / extent, normal / normal_extent) until every group fits: at most `extent` wide
/// (times the least spacing of its elements), its normals within `normal_extent` (chord of the unit sphere) along each axis, and at most `most_elements` elements.
Partition partitionByExtent(std::span<const SurfaceElement> elements, float extent, float normal_extent, size_t most_elements);

/// The same with the extent found by bisection so that the number of groups comes as near to `count` as it can (deterministic).
Partition partitionByCount(std::span<const SurfaceElement> elements, size_t count, float normal_extent, size_t most_elements);

/// Two or more elements in two, at the middle of the extent that parts them most; turns count as in groups of about the elements' own extent. Lists of indices.
std::array<std::vector<uint32_t>, 2> bisect(std::span<const SurfaceElement> elements);

}  // namespace lightwell::transport
