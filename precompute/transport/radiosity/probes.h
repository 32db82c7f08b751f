// Where light is known for things that move: the places of probes, on a lattice and at points that were asked for.
//
// Lattice points inside of things are moved to where they see, or left out; so are points in pockets that no light of the scene can enter. What a probe sees
// how near says, later, from where it may be looked at (nearness below), so that no light is interpolated through a wall.
#pragma once
#include <array>
#include <vector>

#include "precompute/transport/radiosity/gated_hits.h"

namespace lightwell::transport {

/// Points first + spacing · (x, y, z), each coordinate from 0 to its count − 1.
struct ProbeLattice {
  Vec3 first{0, 0, 0};
  float spacing = 0;  // internal units; 0: no lattice
  std::array<uint32_t, 3> count{0, 0, 0};

  uint64_t size() const { return uint64_t(count[0]) * count[1] * count[2]; }
  Vec3 point(uint32_t index) const;
};

inline constexpr uint64_t kMostLatticePoints = uint64_t(1) << 22;
inline constexpr int kNearnessCells = 16;                                         // along a side of the octahedral square
inline constexpr int kNearnessNodes = (kNearnessCells + 1) * (kNearnessCells + 1);  // row by row, from (−1, −1)
/// A probe may lie this far from its lattice point along each axis, in spacings, in steps of 1 / 254.
inline constexpr float kMostProbeOffset = 0.5f;

struct Probes {
  ProbeLattice lattice;
  // Of the probes on the lattice, which come first.
  std::vector<uint32_t> lattice_point;              // x + count[0] · (y + count[1] · z); ascending
  std::vector<std::array<int8_t, 3>> offset;        // from the lattice point, spacing / 254
  /// [kNearnessNodes] each: spacing over the distance of the first surface in the direction of the node, the distance measured as |x| + |y| + |z|; 0: none. Over an octahedron this is
  /// linear for a plane, so that interpolation between nodes is exact for walls.
  std::vector<float> nearness;
  std::vector<Vec3> position;                       // of all, internal units: the lattice's, then the points as they were given
  // What became of the other points of the lattice.
  uint32_t moved = 0, inside = 0, sealed = 0;

  uint32_t count() const { return uint32_t(position.size()); }
};

struct ProbeOptions {
  float spacing = 0;          // internal units; 0: no lattice
  uint32_t budget = 0;        // with spacing 0: the finest lattice of so many points at most; 0: none
  std::vector<Vec3> points;   // internal units
  uint64_t seed = 1;
  int threads = 0;
  const CancelFlag* cancel = nullptr;
};

/// The lattice that fills the bounds: half a spacing from their sides. Throws UsageError when it has more than kMostLatticePoints.
ProbeLattice makeProbeLattice(const Box3& bounds, const ProbeOptions& options, double metres_per_unit);

/// `shut`: tracer of the scene with all portals shut: no light is interpolated through a door's leaf. `gated` tells which probes are in the same air.
Probes placeProbes(const scene::Scene& scene, const trace::Tracer& shut, const GatedTracer& gated, uint32_t patches, const ProbeOptions& options);

}  // namespace lightwell::transport
