// The error of a light map, measured at a sample of its texels with path tracing, and how sure that is.
#pragma once
#include <span>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

/// Texels to measure at: more of the bright ones, which decide the error, and a weight each that makes sums over them stand for all.
struct MeasuredTexels {
  std::vector<uint32_t> slot;  // ascending
  std::vector<float> weight;
};
/// `most` texels, or all when there are no more. `density` per slot, > 0: what the chance of each is proportional to.
MeasuredTexels chooseTexels(std::span<const uint32_t> density, uint32_t most, uint64_t seed);

/// A square root of a mean square, with an interval that holds the true one in about 95 of 100 cases.
struct EstimatedError {
  double value = 0, low = 0, high = 0;
};
struct LightmapError {
  size_t texels = 0;
  EstimatedError relrmse, texrel;  // docs/cli.md
  double bias = 0;
};

/// `references`: three or more independent path-traced maps of the chosen texels, in their order; their noise is taken out as in pooled_error.h. The interval is that of a ratio of two weighted sums
/// (Cochran, "Sampling Techniques", 1977, chapter 6). No texels when nothing is lit.
LightmapError measureLightmap(std::span<const std::vector<Rgb>> references, std::span<const Rgb> candidate_rgb, std::span<const float> weight);

}  // namespace lightwell::transport
