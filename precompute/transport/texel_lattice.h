// Values on a lattice of texels, refined where they are not smooth and interpolated elsewhere.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"

namespace lightwell::transport {

struct LatticeOptions {
  uint32_t coarsest = 8;     // texels between values at first, a power of two; 1: every texel for itself
  float curvature = 0.005f;  // error of linear interpolation, as neighbouring differences tell it, relative to the value and a tenth of the mean
  float contrast = 0.15f;    // of the values that are interpolated between, likewise: an edge of a shadow may lie there
};

/// Fills one value for each of the given slots, in their order; called from several threads.
using SlotValues = std::function<void(std::span<const uint32_t> slots, std::span<Rgb> values)>;

/// One value per slot. A slot between two known ones of its chart (or four, diagonally) is not evaluated but interpolated when the differences beyond them say that the value is smooth,
/// when surface and distances go on evenly, and when nothing stands on the surface so close that it might change the light between them: as in irradiance caching (Ward, Rubinstein, Clear,
/// "A Ray Tracing Solution for Diffuse Interreflection", 1988), nearness bounds how fast irradiance changes. Borders of charts are always evaluated.
/// The result does not depend on `threads`. `evaluated`: NULL, or receives the number of slots that were not interpolated. Throws Cancelled.
std::vector<Rgb> valuesOverLattice(const atlas::Atlas& atlas, const trace::Tracer& tracer, const LatticeOptions& options, int threads, const CancelFlag* cancel,
                                   const SlotValues& evaluate, size_t* evaluated);

}  // namespace lightwell::transport
