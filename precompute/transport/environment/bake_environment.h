// From a map to what the container holds.
#pragma once
#include "precompute/transport/environment/decompose.h"
#include "precompute/transport/environment/environment_map.h"

namespace lightwell::transport {

struct EnvironmentSettings {
  DecompositionSettings decomposition;
  /// Cells along a face of the sky's cube, even, 16 to 256: 150 kB at 64. Lobes with shininess up to (1.5 · this / π)² / 0.7 are resolved.
  uint32_t sky_face_cells = 64;
  int grid_width = 2048;  // columns of the working resolution at most, ≥ 64
};

/// Reads the map once. The same map, settings and seed give the same result for any number of threads. Throws InputError, UsageError,
/// Cancelled.
Environment bakeEnvironment(EnvironmentMap& map, const EnvironmentSettings& settings, Diagnostics& diagnostics, const CancelFlag* cancel);

/// The same from a map that was read already.
Environment bakeEnvironment(const SkyGrid& grid, const EnvironmentSettings& settings, const CancelFlag* cancel);

/// The sky of a grid without the texels whose label is below `sun_count`.
EnvironmentSky bakeSky(const SkyGrid& grid, const std::vector<uint32_t>& label, uint32_t sun_count, uint32_t face_cells, int threads);

}  // namespace lightwell::transport
