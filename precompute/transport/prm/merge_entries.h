// Entry points that the finished blocks cannot tell apart.
#pragma once
#include "precompute/transport/prm/prm.h"

namespace lightwell::transport {

/// Makes one cluster of those under each node of the tree that blocks and probes know, if at all, by its mean alone: no finer wavelet changes a texel by more than a step. Its light is still that of
/// all of its surface, looked for at no more than `most_points` entry points. Returns how many clusters there are fewer. Local bases only.
uint32_t mergeUnlinked(PrmResult& prm, uint32_t most_points);

}  // namespace lightwell::transport
