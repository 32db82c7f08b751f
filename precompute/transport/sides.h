// The lit sides of the surface: every texel's front, and the back of double-sided ones. Light enters and leaves the transport through these.
#pragma once
#include <vector>

#include "precompute/atlas/atlas.h"

namespace lightwell::transport {

/// Sides [0, front_count) are the fronts of the atlas's slots, in their order; then come the backs of double-sided slots.
struct Sides {
  std::vector<uint32_t> slot;          // of each side
  std::vector<uint32_t> back_of_slot;  // side index, or kNone for single-sided slots
  uint32_t front_count = 0;

  bool isBack(uint32_t side) const { return side >= front_count; }
  /// The side of `slot` that a ray meets, or kNone when it is the unlit back of a single-sided surface.
  uint32_t met(uint32_t slot_index, bool front) const { return front ? slot_index : back_of_slot[slot_index]; }
};

Sides surfaceSides(const atlas::Atlas& atlas);

/// A point of the side's surface, with normals on that side. Inputs as atlas::sampleSlot.
atlas::SurfacePoint sampleSide(const scene::Mesh& mesh, const atlas::Atlas& atlas, const Sides& sides, uint32_t side, float pick, const Vec2& u);

}  // namespace lightwell::transport
