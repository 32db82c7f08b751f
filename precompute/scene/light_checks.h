// What glTF and LIGHTS.json ask of a punctual light, whichever file it came from.
#pragma once
#include <string>

#include "precompute/core/diagnostics.h"
#include "precompute/core/math.h"
#include "precompute/scene/scene.h"

namespace lightwell::scene {

/// Sets the intensity to colour × intensity (candela or lux), negative components zero, and warns about implausible values at `place`.
void setIntensity(Light& light, const Vec3d& color, double intensity, const std::string& place, Diagnostics& diagnostics);

/// Sets the cone (radians), repaired to 0 ≤ inner < outer ≤ π/2 with a warning at `place`.
void setCone(Light& light, double inner_cone_angle, double outer_cone_angle, const std::string& place, Diagnostics& diagnostics);

}  // namespace lightwell::scene
