// How fast rays are, beside Embree with nothing around it.
#pragma once
#include "cli/report/result.h"
#include "precompute/bake/context.h"

namespace lightwell::report {

/// Closest hits of cosine-distributed rays from random texels, CPU seconds of one thread, the median of rounds that take turns. The context has a tracer.
RayRate measureRays(const bake::BakeContext& context);

}  // namespace lightwell::report
