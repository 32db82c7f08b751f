// From patches to texels: which patches a texel of the light map shows, interpolated within its chart.
#pragma once
#include <array>
#include <vector>

#include "precompute/transport/radiosity/patches.h"

namespace lightwell::transport {

/// Irradiance of a texel = Σ_k weight[k] · irradiance(patch[k]); weights ≥ 0 with the sum 1.
struct TexelWeights {
  std::vector<uint32_t> slot;                   // ascending; the fronts of slots that have patches
  std::vector<std::array<uint32_t, 4>> patch;   // the first: the texel's own; unused ones: kNone, weight 0
  std::vector<std::array<float, 4>> weight;
};

/// Bilinear between the squares of the own patch's size around a texel, as far as they are of its chart and its material; patches of other orientation than
/// its own do not mix in either.
TexelWeights makeTexelWeights(const atlas::Atlas& atlas, const Sides& sides, const Patches& patches);

}  // namespace lightwell::transport
