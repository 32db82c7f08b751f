// First positions of the cells' seeds, before relaxation.
#pragma once
#include <vector>

#include "precompute/transport/environment/sky_grid.h"

namespace lightwell::transport {

/// What seeds follow: solid angle × (luminance of the radiance)^exponent per texel, with a floor so that dark parts of the sky have cells
/// too, and no texel above a seed's fair share (more than one seed in a texel is no use). 0 where the solid angle is 0; sums to 1.
std::vector<double> seedImportance(const SkyGrid& grid, double exponent, uint32_t seeds);

/// Blue noise with a density proportional to importance: weighted sample elimination (Yuksel, "Sample Elimination for Generating Poisson
/// Disk Sample Sets", 2015) among low-discrepancy candidates drawn by importance. Deterministic in `seed`. Returns min(count, useful
/// texels) directions.
std::vector<Vec3> blueNoiseSeeds(const SkyGrid& grid, const std::vector<double>& importance, uint32_t count, uint64_t seed);

/// Fast: the texels are cut in two where their power is, again and again, always the part whose power is spread most (after Viriyothai and
/// Debevec, "Variance Minimization Light Probe Sampling", 2009, with planes through the sphere instead of lines in the map).
std::vector<Vec3> bisectionSeeds(const SkyGrid& grid, const std::vector<double>& importance, uint32_t count);

}  // namespace lightwell::transport
