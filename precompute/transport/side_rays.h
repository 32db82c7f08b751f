// Cosine-distributed rays from pieces of the surface: what every gathering estimator traces.
#pragma once
#include <span>
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

/// `rays` rays from points spread evenly over the area of the sides `members`, their directions with density cos / pi about the shading normal. Those that
/// would leave below the geometric surface are left out, so that there may be fewer; they carry nothing, but count. `stream` names the
/// random numbers within the bake's `seed`, and keys the rays' passage through BLEND surfaces.
std::vector<trace::Ray> cosineRays(const scene::Mesh& mesh, const atlas::Atlas& atlas, const Sides& sides, std::span<const uint32_t> members,
                                   uint32_t rays, uint64_t seed, uint64_t stream);

}  // namespace lightwell::transport
