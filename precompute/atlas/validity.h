// Buried and leaking texels: found with rays, filled from valid neighbours.
#pragma once
#include "precompute/atlas/atlas.h"
#include "precompute/trace/tracer.h"

namespace lightwell::atlas {

struct ValidityReport {
  uint32_t buried = 0;    // slots whose rays mostly meet back faces of single-sided surfaces
  uint32_t unfilled = 0;  // buried slots of charts without a single valid slot; they keep their own value
};

/// Casts a few rays per slot over the hemisphere of its normal. Rewrites Atlas::source so that buried slots and gutters show the
/// nearest valid texel of their chart. Deterministic for `seed`. Slots stay in Atlas::slots.
ValidityReport fillInvalid(Atlas& atlas, const scene::Scene& scene, const trace::Tracer& tracer, uint64_t seed, int threads,
                           const CancelFlag* cancel);

}  // namespace lightwell::atlas
