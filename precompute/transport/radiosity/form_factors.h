// Form factors between patches, from cosine-distributed rays at both ends.
//
// "Realtime global illumination (part 1)" (Rasmus' blog, 2016), section Computing form factors: samples spread over the clipped polygons of a texel,
// each hit counts one over the number of samples. Here the patches at both ends of a pair speak for it, so that reciprocity A_i F_ij = A_j F_ji holds exactly.
#pragma once
#include <span>
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/radiosity/patches.h"

namespace lightwell::transport {

/// Sparse rows over patches, one per receiver.
struct FormFactors {
  std::vector<uint64_t> first = {0};  // rows + 1
  std::vector<uint32_t> patch;        // ascending within a row
  std::vector<float> value;           // F_ij: the cosine-weighted share of patch i's hemisphere that patch j fills, 0 to 1
  uint32_t rows() const { return uint32_t(first.size()) - 1; }
};

/// How many of a patch's rays met each patch; what they met else (the sky, unlit backs, the inside of things) is not counted.
struct HitCounts {
  std::vector<uint64_t> first = {0};
  std::vector<uint32_t> patch, count;
  /// Appends another's rows.
  void append(const HitCounts& other);
};

/// Traces `rays` rays from each of the patches [begin, end).
HitCounts countHits(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches,
                    uint32_t rays, uint64_t seed, uint32_t begin, uint32_t end);

/// Form factors from the hits of all patches (`rays` each). The exchange A_i F_ij is estimated from both ends' hits together, weighted as their
/// variances are, and then balanced so that every row keeps the sum that its own rays found, which has the least noise: 1 in closed rooms.
FormFactors makeFormFactors(const Patches& patches, const HitCounts& hits, uint32_t rays);

}  // namespace lightwell::transport
