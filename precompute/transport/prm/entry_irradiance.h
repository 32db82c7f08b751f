// Direct irradiance at entry points, as a game computes it each frame; here with ray-traced shadows.
#pragma once
#include <span>
#include <vector>

#include "precompute/trace/tracer.h"
#include "precompute/transport/prm/prm.h"

namespace lightwell::transport {

/// Shadowed irradiance of one light, averaged over each cluster's entry points: one value per cluster.
std::vector<Rgb> clusterIrradiance(const PrmEntries& entries, const trace::Tracer& tracer, const scene::Light& light);

}  // namespace lightwell::transport
