// Punctual lights with the physics of KHR_lights_punctual. The same numbers and the same formula run on the CPU and in the shaders.
#pragma once
#include <cmath>

#include "runtime/src/host.h"

namespace lightwell::runtime {

/// What GLSL knows as LwLight; the order of lw_gl_pack_light.
struct PackedLight {
  float position_m[3] = {}, range_m = 0;
  float direction[3] = {}, type = 0;         // unit
  float intensity_rgb[3] = {}, unused = 0;
  float spot_scale = 0, spot_offset = 1, unused2[2] = {};
};
static_assert(sizeof(PackedLight) == 16 * sizeof(float));
inline bool isType(const PackedLight& light, uint32_t type) { return light.type == float(type); }

/// Null when the light's values are in range, else what is wrong.
const char* packLight(const lw_light& light, PackedLight& packed);

/// Beyond this nothing is a sensible irradiance; it keeps sums finite when a light touches a surface.
inline constexpr float kMaxIrradiance = 1e30f;

/// Irradiance at `position` about `normal`, unoccluded; false when it is zero. `to_light` is the unit direction toward the light and
/// `distance_m` its distance.
bool lightIrradiance(const PackedLight& light, const float* position_m, const float* normal, float* irradiance_rgb, float* to_light,
                     float& distance_m);

/// What the mean over a rectangle is of the value at its middle, for a light at `to_light_m` from the middle: (solid angle / area) / (cos / distance²).
/// `rectangle`: half its sides in metres, and the turn of the first about `normal` in half turns (docs/format.md, section prm, entry_rectangle).
float rectangleGain(const float* to_light_m, const float* normal, const float* rectangle);

}  // namespace lightwell::runtime
