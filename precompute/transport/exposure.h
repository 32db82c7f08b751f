// How much of a texel's surface is in the open, and how much lies inside other things: under a box, in a wall.
#pragma once
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

/// Per side of `sides` the share of its area that is exposed, in [0, 1]: the share of points from which at most half of the rays meet back faces of single-sided
/// surfaces. Light neither reaches the rest nor is it seen, so means over the whole area would be too dark along every line of contact.
std::vector<float> exposedShare(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const Sides& sides, uint64_t seed,
                                int threads, const CancelFlag* cancel);

}  // namespace lightwell::transport
