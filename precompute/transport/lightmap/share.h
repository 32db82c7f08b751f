// Gathered light shared between neighbouring texels, as far as the noise of both and the change of the light between them advise.
#pragma once
#include <span>
#include <vector>

#include "precompute/atlas/atlas.h"
#include "precompute/transport/lightmap/gather.h"

namespace lightwell::transport {

/// Per slot; `gradient` as that of GatheredPair.
struct SharedLight {
  std::vector<Rgb> irradiance_rgb;
  std::vector<Vec3> gradient;
};

/// Every slot takes the value there of a plane fitted to the slots around it, of its chart and orientation; the radius (0 to 8 texels) is the one
/// whose fit to one half of the rays predicts the other half best, over the neighbourhood. (Selection of the scale by estimated error: Rousselle, Knaus,
/// Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", 2011; fits of first order: Bitterli et al., "Nonlinearly Weighted
/// First-order Regression for Denoising Monte Carlo Renderings", 2016.) Gradients are averaged over the same radius. `exposed` per slot.
SharedLight shareIrradiance(const atlas::Atlas& atlas, std::span<const float> exposed, const GatheredPair& gathered, int threads, const CancelFlag* cancel);

}  // namespace lightwell::transport
