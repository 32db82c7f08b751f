// Form factors between patches, from cosine-distributed rays at both ends.
//
// "Realtime global illumination (part 1)" (Rasmus' blog, 2016), section Computing form factors: samples spread over the clipped polygons of a texel,
// each hit counts one over the number of samples. Here the patches at both ends of a pair speak for it, so that reciprocity A_i F_ij = A_j F_ji holds exactly.
#pragma once
#include <span>
#include <vector>

#include "precompute/transport/radiosity/gated_hits.h"

namespace lightwell::transport {

/// Sparse rows over patches, one per receiver. Rows of patches on a leaf are what they receive while they are there: their own closed gate is left out of the sets.
struct FormFactors {
  std::vector<uint64_t> first = {0};  // rows + 1
  std::vector<uint32_t> patch;        // ascending within a row and set
  std::vector<uint32_t> set;          // of gates, ascending within a row; empty without portals
  std::vector<float> value;           // F_ij: the cosine-weighted share of patch i's hemisphere that patch j fills, 0 to 1, where that light passes the set
  GateSets sets;
  std::vector<GateEntry> own_gate;    // per patch: ownGates; empty without portals
  uint32_t rows() const { return uint32_t(first.size()) - 1; }
  uint32_t setOf(uint64_t entry) const { return set.empty() ? 0 : set[entry]; }
};

/// How many of a patch's rays met each patch; what they met else (the sky, unlit backs, the inside of things) is not counted.
struct HitCounts {
  std::vector<uint64_t> first = {0};
  std::vector<uint32_t> patch, count;
  std::vector<uint32_t> set;  // gates that have to be as it says, those of either end included; empty without portals
  GateSets sets;
  /// Appends another's rows.
  void append(const HitCounts& other);
  /// Puts sets into their own order, whatever the order in which they were found.
  void sort();
};

/// Traces `rays` rays from each of the patches [begin, end).
HitCounts countHits(const scene::Scene& scene, const atlas::Atlas& atlas, const GatedTracer& tracer, const Sides& sides, const Patches& patches, uint32_t rays,
                    uint64_t seed, uint32_t begin, uint32_t end);

/// Form factors from the sorted hits of all patches (`rays` each). The exchange A_i F_ij through each set is estimated from both ends' hits together, weighted as their
/// variances are, and then balanced so that every row keeps the sums that its own rays found, with all portals shut and with all open, which have the least noise: 1 in closed rooms.
/// How much of a row passes portals follows from both ends' hits, too.
FormFactors makeFormFactors(const PortalZones& zones, const Patches& patches, const HitCounts& hits, uint32_t rays);

/// Per patch the gate that its light depends on wherever it goes: a leaf's strip, closed; for a threshold the first of the leaf above it, open; else kNoEntry. Empty without portals.
std::vector<GateEntry> ownGates(const PortalZones& zones, const Patches& patches);

/// The number of a set without the gate of the leaf that a zone is on.
uint32_t withoutOwnGate(const PortalZones& zones, const PortalZone& zone, uint32_t set, GateSets& sets);

}  // namespace lightwell::transport
