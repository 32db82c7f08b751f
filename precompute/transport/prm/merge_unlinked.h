// Entry points whose difference no block wants to know.
#pragma once
#include <cstdint>

#include "precompute/trace/tracer.h"
#include "precompute/transport/prm/prm.h"

namespace lightwell::transport {

/// Makes one cluster of neighbours that together are a rectangle, as the solid angle that a light fills over it is exact then, and of which no block and no probe links more than
/// the mean: what tells them apart changes every texel by less than the step that coefficients are rounded to. Answers are the same for every light that shines evenly
/// on the clusters, and where a shadow's edge passes between them it is as coarse as the clusters are now. What a wall or anything else that stands on the surface parts stays apart.
/// @param prm  local bases; those with several entry points to a cluster stay as they are
/// @return how many clusters there are fewer
uint32_t mergeUnlinkedClusters(const trace::Tracer& tracer, PrmResult& prm);

}  // namespace lightwell::transport
