// From patches to texels: which patches a texel of the light map shows, interpolated along the surface.
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

/// Bilinear between four squares of one size where they are all there. Elsewhere, at the borders of charts and of finer squares, linear in the triangle of
/// patches around the texel that Delaunay would choose, wherever in the light map they lie: patches that continue the texel's surface with nothing in between.
TexelWeights makeTexelWeights(const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, const Patches& patches, const PatchTree& tree,
                              int threads, const CancelFlag* cancel);

}  // namespace lightwell::transport
