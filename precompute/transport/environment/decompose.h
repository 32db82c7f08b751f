// Cuts the sphere of directions into cells for one visibility test each.
#pragma once
#include "precompute/core/diagnostics.h"
#include "precompute/transport/environment/environment.h"
#include "precompute/transport/environment/sky_grid.h"
#include "precompute/transport/environment/suns.h"

namespace lightwell::transport {

struct DecompositionSettings {
  uint32_t samples = 128;  // suns included, [1, 4096]; fewer come out when the map has fewer texels with light in them
  uint64_t seed = 0;
  bool fast = false;       // bisection, a coarse grid and few rounds: for skies that change
  /// Seeds and relaxation aim at a density of cells as radiance to this power, in [0, 1]. 1: cells of equal power, solid angles inversely
  /// proportional to radiance, as the paper asks. 0.5: the least squared spread of power in the cells, thus the least error of one sample
  /// each.
  float density_exponent = 0.5f;
  SunSettings suns;
  int threads = 0;         // 0: all. The result does not depend on it
};

struct Decomposition {
  EnvironmentCells cells;
  std::vector<uint32_t> label;  // the cell of each texel of `grid`
};

/// Lloyd relaxation on the sphere of seeds laid by importance, then exact sums over `grid`. Throws UsageError for unusable settings.
Decomposition decompose(const SkyGrid& grid, const DecompositionSettings& settings, const CancelFlag* cancel);

}  // namespace lightwell::transport
