// Where errors are measured, and how many paths that takes.
#pragma once
#include <span>
#include <vector>

#include "precompute/atlas/atlas.h"

namespace lightwell::transport {

/// How many independent references there are: pairs of them give an error, the others its weight (pooled_error.h).
inline constexpr uint32_t kMeasuringReferences = 4;

/// Texels to measure at, and a weight each that makes sums over them stand for all.
struct MeasuredTexels {
  std::vector<uint32_t> slot;  // ascending
  std::vector<float> weight;
};
/// `most` texels, or all when there are no more; fewer when one was chosen twice. `density` per slot, > 0: what the chance of each is proportional to.
MeasuredTexels chooseTexels(std::span<const uint32_t> density, uint32_t most, uint64_t seed);

/// Rays of a path, about, each segment with its shadow ray: the geometric series of the mean albedo.
double raysPerPath(const atlas::Atlas& atlas);
/// Paths per texel in each reference: 64, but 4 where surfaces are nearly white and paths long.
uint32_t measuringPaths(const atlas::Atlas& atlas);

}  // namespace lightwell::transport
