// Which clusters of entry points need no detail, since light never comes straight to them.
#pragma once
#include <span>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/prm/prm.h"

namespace lightwell::transport {

/// Per cluster, whether none of the lights reaches any of its entry points; of none, if there are no lights. `threads`: 0 for all of the machine; the result does not depend on it. Throws
/// Cancelled; `cancel` may be null.
std::vector<char> unreachedClusters(const PrmEntries& entries, const trace::Tracer& tracer, std::span<const PriorLight> lights, int threads = 0,
                                    const CancelFlag* cancel = nullptr);

}  // namespace lightwell::transport
