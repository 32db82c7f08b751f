// How fine a light map has to be.
#pragma once
#include "precompute/core/diagnostics.h"
#include "precompute/scene/scene.h"

namespace lightwell::plan {

inline constexpr int kLeastChosenSize = 16, kMostChosenSize = 2048;

struct ChosenSize {
  int size = 0;          // texels along each side of the atlas: a power of two
  double variation = 0;  // probeVariation() at that size; above the target only at kMostChosenSize
};

/// The smallest light map in whose texels indirect irradiance varies by at most `target` (probeVariation), and into which the scene's charts fit. A scene without surfaces gets kLeastChosenSize.
/// Throws InputError when charts do not fit into kMostChosenSize, Cancelled. `cancel` may be null.
ChosenSize chooseLightmapSize(const scene::Scene& scene, double target, uint64_t seed, int threads, const CancelFlag* cancel);

}  // namespace lightwell::plan
