// Buried and leaking texels: found with rays, filled from valid neighbours.
#pragma once
#include <span>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"

namespace lightwell::atlas {

struct ValidityReport {
  uint32_t buried = 0;    // slots whose rays mostly meet back faces of single-sided surfaces
  uint32_t unfilled = 0;  // buried slots of charts without a single valid slot; they keep their own value
};

/// Casts a few rays per slot [first, end) over the hemisphere of its normal: whether its value may be shown (1) or it is buried (0).
/// Deterministic for `seed`.
std::vector<uint8_t> validSlots(const Atlas& atlas, const scene::Scene& scene, const trace::Tracer& tracer, uint64_t seed, size_t first,
                                size_t end);

/// Rewrites Atlas::source so that buried slots (`valid`, one per slot) and gutters show the nearest valid texel of their chart. Slots
/// stay in Atlas::slots.
ValidityReport fillInvalid(Atlas& atlas, std::span<const uint8_t> valid);

/// Both in one.
ValidityReport fillInvalid(Atlas& atlas, const scene::Scene& scene, const trace::Tracer& tracer, uint64_t seed, int threads,
                           const CancelFlag* cancel);

}  // namespace lightwell::atlas
