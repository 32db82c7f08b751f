// The radiosity equation, converged, in double precision: what every runtime solver must agree with.
#pragma once
#include <span>
#include <vector>

#include "precompute/transport/radiosity/links.h"

namespace lightwell::transport {

struct RadiositySolution {
  std::vector<Rgb> irradiance_rgb;  // per patch: received from other patches, emitters among them; without what lights give directly
  uint32_t sweeps = 0;              // products with the links
  double residual = 0;              // rms of what another sweep would change, over rms of the irradiance
};

/// Solves E = F (ρ (E + direct) + emitted) for E. `albedo_rgb` in [0, 1), `direct_rgb` irradiance from lights, `emitted_rgb` radiosity (π times
/// radiance); one per patch. Fixed-point sweeps with Anderson's acceleration (Anderson 1965; Walker, Ni, "Anderson Acceleration for Fixed-Point Iterations", 2011),
/// because plain sweeps gain only a factor of the albedo each. `gate_open`: how far each gate is open, 0 to 1; empty: all are shut.
RadiositySolution solveRadiosity(const RadiosityLinks& links, const PatchTree& tree, std::span<const Rgb> albedo_rgb, std::span<const Rgb> direct_rgb,
                                 std::span<const Rgb> emitted_rgb, double tolerance = 1e-7, uint32_t most_sweeps = 1000,
                                 std::span<const float> gate_open = {});

}  // namespace lightwell::transport
