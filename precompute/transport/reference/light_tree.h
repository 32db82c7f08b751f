// A tree over many lights from which one is picked by how much it may give to a point, in logarithmic time.
// Conty Estevez, Kulla: "Importance Sampling of Many Lights with Adaptive Tree Splitting" (2018): bounds of position, orientation and
// power per node, an importance made of them, the surface area orientation heuristic.
#pragma once
#include <span>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// What a group of lights may do: where it is, whither it shines, how strongly.
struct LightBounds {
  Box3 box;                 // internal units
  Vec3 axis{0, 0, 1};       // unit; the light leaves within `normal_spread` + `emission_spread` of it
  float normal_spread = 0;  // radians around the axis that hold every emitter's own axis, in [0, π]
  float emission_spread = 0;  // radians around each emitter's axis that it shines into, in [0, π]
  bool two_sided = false;   // shines likewise about -axis
  float power = 0;          // any measure that is proportional to what is given, ≥ 0
};

/// Points on a surface: a sphere around them and a cone around their normals.
struct Receivers {
  Vec3 center{0, 0, 0};
  float radius = 0;
  Vec3 normal{0, 0, 1};
  float cos_spread = 1;
};

class LightTree {
 public:
  LightTree() = default;
  /// Items of zero power are left out: they are never picked and have probability 0.
  explicit LightTree(std::span<const LightBounds> items);

  bool empty() const { return nodes_.empty(); }

  struct Pick {
    uint32_t item = kNone;  // kNone: nothing can shine on the point
    float probability = 0;
  };
  /// Picks an item for a point with unit normal `normal`, receiving over the half space of the normal. `u` in [0, 1).
  Pick pick(const Vec3& position, const Vec3& normal, float u) const;
  /// The probability with which `pick` returns `item`.
  float probability(uint32_t item, const Vec3& position, const Vec3& normal) const;

  // For cuts (light_cut.h). Nodes are numbered, the root is 0.
  uint32_t nodeCount() const { return uint32_t(nodes_.size()); }
  /// Of its two children, which follow each other; kNone: the node is one item.
  uint32_t firstChild(uint32_t node) const { return nodes_[node].first_child; }
  /// `pick` among the items of a node.
  Pick pickIn(uint32_t node, const Vec3& position, const Vec3& normal, float u) const;
  /// Upper bound of what a node's items give to any of these points, in units of power ÷ length², for items that shine with the cosine
  /// of the angle to their axis: irradiance times pi for a power in lumen. Infinite when they may be in the same place.
  float bound(uint32_t node, const Receivers& receivers) const;

 private:
  /// LightBounds as `importance` wants them: sphere and cosines instead of box and angles.
  struct Reach {
    Vec3 center;
    float radius2;
    Vec3 axis;
    float cos_normal_spread, sin_normal_spread, cos_emission_spread;
    float power;
    bool two_sided;

    explicit Reach(const LightBounds& bounds);
    /// Upper estimate, up to a common factor, of the irradiance given to a point. Zero only when nothing is given.
    float importance(const Vec3& position, const Vec3& normal) const;
    float bound(const Receivers& receivers) const;
  };
  struct Node {
    Reach reach{LightBounds{}};
    uint32_t parent = kNone;
    uint32_t first_child = kNone;  // the second one follows it; kNone: a leaf
    uint32_t item = kNone;
  };
  /// Chance of the first child, of the two at `first_child`; negative when neither can shine on the point.
  float firstChildProbability(uint32_t first_child, const Vec3& position, const Vec3& normal) const;

  std::vector<Node> nodes_;
  std::vector<uint32_t> leaf_;  // item to node, kNone for items left out
};

}  // namespace lightwell::transport
