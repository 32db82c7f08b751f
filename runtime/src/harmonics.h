// Radiance in spherical harmonics up to band 2: what moving objects are lit with.
#pragma once
#include <cstdint>

namespace lightwell::runtime {

inline constexpr uint32_t kHarmonics = 9;

/// Y of a unit direction, in the order of lw_environment_info.sky_radiance_sh.
void harmonics(float x, float y, float z, float* basis);

/// Scales all bands but the first until irradiance is nowhere negative: a window (Sloan: "Stupid Spherical Harmonics (SH) Tricks", 2008, section Ringing) as narrow as this light needs. The
/// mean stays. `sh`: [9] integrals of radiance times Y, per channel.
void keepIrradiancePositive(float (*sh)[3]);

}  // namespace lightwell::runtime
