// The plain evaluation of a PRM, in the layout that the bake holds: what every runtime evaluator must agree with.
#pragma once
#include <span>
#include <vector>

#include "precompute/transport/prm/prm.h"

namespace lightwell::transport {

/// Indirect irradiance per value of PrmResult::texel for direct irradiance per cluster; never negative. `brightest` > 0 keeps only that many
/// panes, those with the most light, scaled per channel so that the energy of all is kept; 0 keeps all. Emitters are not included.
std::vector<Rgb> evaluatePrm(const PrmResult& prm, std::span<const Rgb> cluster_irradiance_rgb, uint32_t brightest = 0);

}  // namespace lightwell::transport
