// Data-parallel loops over index ranges. Results never depend on the number of threads: a body writes only to its own indices.
#pragma once
#include <cstddef>
#include <functional>

#include "precompute/core/diagnostics.h"

namespace lightwell {

/// Calls body(begin, end) over [0, count) in pieces of at most `grain` on `threads` threads (0: all of the machine).
/// Checks `cancel` (may be null) before each piece and throws Cancelled. The first exception of a body is rethrown here.
void parallelFor(size_t count, size_t grain, int threads, const CancelFlag* cancel,
                 const std::function<void(size_t begin, size_t end)>& body);

/// The number of threads that 0 stands for.
int hardwareThreads();

}  // namespace lightwell
