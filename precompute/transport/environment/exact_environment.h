// Quadrature over the map itself: the truth that answers are measured with.
#pragma once
#include <span>

#include "precompute/transport/environment/environment_map.h"
#include "precompute/transport/environment/evaluate_environment.h"

namespace lightwell::transport {

/// Σ over all texels of L ∫ max(0, cos ψ)^n dω; texels are cut in parts where the lobe is narrow against them. One pass over the map.
std::vector<Rgb> exactAnswers(EnvironmentMap& map, std::span<const EnvironmentQuery> queries, int threads, Diagnostics& diagnostics,
                              const CancelFlag* cancel);

}  // namespace lightwell::transport
