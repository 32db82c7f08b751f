// Probes for moving objects, and where they may be looked at from. docs/format.md gives the meaning of the container's arrays.
#pragma once
#include "format/decode/headers.h"
#include "runtime/src/radiosity.h"

namespace lightwell::runtime {

inline constexpr uint32_t kProbeBrick = 4;        // lattice points along a brick
inline constexpr uint32_t kBrickPoints = 64;
inline constexpr uint32_t kNearnessCells = 16, kNearnessNodes = 289;
inline constexpr uint32_t kMostProbes = 1u << 22;
inline constexpr uint32_t kProbeCorners = 8;

/// A link of a probe: node << 8 | code, and the direction to the node's middle as two signed 16-bit octahedral numbers, x in the lower half.
struct ProbeLink {
  uint32_t node_code, direction;
};

/// The eight lattice points around a position that have probes, and how much each is to count.
struct ProbeCorners {
  uint32_t count = 0;
  uint32_t probe[kProbeCorners];
  float weight[kProbeCorners];  // sum 1
};

}  // namespace lightwell::runtime

struct lw_probes {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lightwell::format::ProbesHeader header;
  uint32_t patches = 0, nodes = 0, gates = 0, gate_sets = 1;
  uint32_t brick_count[3] = {};

  Array<float> position_m;               // [probes][3]
  Array<uint32_t> brick;                 // [bricks]: first of 64 entries in brick_probe, or none
  Array<uint32_t> brick_probe;           // [bricks with probes][64]: a probe, or none
  Array<uint32_t> offset_biased;         // [lattice probes]: three bytes from the lowest, offset + 128
  Array<uint8_t> nearness;               // [lattice probes][289]

  Array<lightwell::runtime::ProbeLink> link;
  Array<uint32_t> first_run;             // [probes + 1]
  Array<lightwell::runtime::LinkRun> run;
  Array<float> scale;                    // [probes]
  Array<uint32_t> gate_set_first;        // [gate sets + 1]
  Array<uint16_t> gate_set;              // gate * 2 + closed

  uint32_t probes() const { return header.lattice_probes + header.points; }
};

namespace lightwell::runtime {

/// Finds the probes around a position and weighs them. None without a lattice, or where it has no probes.
ProbeCorners probeCorners(const lw_probes& probes, const float* position_m);

}  // namespace lightwell::runtime
