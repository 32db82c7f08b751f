// How surfaces lie to the portals of a scene: on a leaf, right under one, on this or on that side of it. What lies on different sides must not become one patch, or light would
// pass a shut door inside of the patch.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "precompute/transport/radiosity/gate_sets.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

/// A texel's side, or a patch of such sides, with respect to portals.
struct PortalZone {
  enum Kind : uint16_t {
    beside,     // some leaves, or far away from all
    threshold,  // reaches over from one side of a leaf to the other: light enters and leaves only while the strip is open
    leaf,       // on the leaf: there only while the strip is closed
    divided,    // belongs to a leaf's two faces, or to a leaf and to something else: no patch can be made of it
  };
  Kind kind = beside;
  uint16_t portal = 0;            // of the others
  uint16_t strip = 0;             // of a leaf
  std::vector<int32_t> near = {}; // the leaves that it is beside, ascending: number + 1, negative on one side of it

  auto operator<=>(const PortalZone&) const = default;
  /// Whether light is there only for a state of the portal.
  bool hasGate() const { return kind == threshold || kind == leaf; }
};

/// Whether a texel may show a mean of patches of both zones.
bool mayMix(const PortalZone& a, const PortalZone& b);

class PortalZones {
 public:
  explicit PortalZones(const scene::Scene& scene);

  bool empty() const { return scene_.portals.empty(); }
  uint32_t gates() const { return gates_; }
  /// The gate of a point of a leaf's triangle; kNone for other triangles.
  uint32_t gateOf(uint32_t triangle, const Vec3& point) const;
  /// The portal that has a gate.
  uint32_t portalOf(uint32_t gate) const;
  uint32_t firstGate(uint32_t portal) const { return first_gate_[portal]; }

  /// Per side. Surfaces are near a leaf when squares of `square_texels` texels along a side, or those with their neighbours, could reach across it.
  std::vector<PortalZone> ofSides(const atlas::Atlas& atlas, const Sides& sides, uint32_t square_texels) const;
  /// What light that leaves or arrives at a point of a zone depends on, beside what it meets on its way; kNoEntry: nothing.
  GateEntry entryAt(const PortalZone& zone, const Vec3& point) const;

 private:
  /// A leaf as a box: along the way it opens, up, and through.
  struct Leaf {
    Vec3d origin, along, up, through;
    double width, height, thickness;  // origin is the middle of the box
    double across(const Vec3& p) const { return (Vec3d(p) - origin).dot(through); }
    /// Whether a point lies in the prism through the leaf, widened by `reach`.
    bool isIn(const Vec3& p, double reach) const;
  };
  PortalZone zoneOf(const atlas::Atlas& atlas, const atlas::Slot& slot, double reach) const;
  bool isOnTwoSides(const Leaf& leaf, std::span<const Vec3> corners, const Vec3& middle) const;

  const scene::Scene& scene_;
  std::vector<Leaf> leaf_;
  std::vector<uint32_t> first_gate_;
  uint32_t gates_ = 0;
};

}  // namespace lightwell::transport
