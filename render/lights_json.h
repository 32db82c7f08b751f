// LIGHTS.json: the punctual lights of a picture.
//
//   {"lights": [{"type": "point" | "spot" | "directional", "position": [x, y, z], "direction": [x, y, z], "color": [r, g, b],
//                "intensity": candela or lux, "innerConeAngle": rad, "outerConeAngle": rad, "range": m}]}
#pragma once
#include <filesystem>
#include <string_view>
#include <vector>

#include "lightwell/lightwell.h"

namespace lightwell::render {

/// Positions are glTF world coordinates in the file and relative to `origin_m` (lw_scene_info) in the result. Throws FileError.
std::vector<lw_light> readLights(const std::filesystem::path& file, const double origin_m[3]);
/// The same from text; `file` only names it in errors.
std::vector<lw_light> parseLights(std::string_view json, const std::string& file, const double origin_m[3]);

}  // namespace lightwell::render
