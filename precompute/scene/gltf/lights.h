// KHR_lights_punctual.
#pragma once
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/gltf/document.h"
#include "precompute/scene/gltf/nodes.h"
#include "precompute/scene/import.h"

namespace lightwell::scene::gltf {

/// A light in metres and candela (lux for directional lights); `position` of the light is not set.
struct PlacedLight {
  Light light;
  Vec3d position_m{0, 0, 0};
};

/// The lights at their places. Negative colours and intensities, broken cones and ranges are repaired, implausible
/// intensities reported. Throws InputError for values of a wrong type and unknown light types.
std::vector<PlacedLight> readLights(Document& document, const std::vector<Placement>& placements, LightUnits units,
                                    Diagnostics& diagnostics);

/// What an intensity of the file is multiplied by to give candela (point, spot) or lux (directional).
///
/// The glTF exporter of Blender (glTF-Blender-IO, `PBR_WATTS_TO_LUMENS`) writes a lamp of P watts as 683 P / (4π) in its "standard" mode,
/// P / (4π) in "unitless" and P in "raw", and a sun of S W/m² as 683 S, S and S. So the same file exported in either mode gives
/// the same light here when the mode is named.
double photometricFactor(LightType type, LightUnits units);

}  // namespace lightwell::scene::gltf
