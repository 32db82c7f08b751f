// CAM.json: a view as a file, for `lightwell render --camera` and the samples.
//
//   {"eye": [x, y, z], "target": [x, y, z],     metres, glTF world coordinates; "direction" may stand in for "target"
//    "up": [0, 1, 0], "vertical_fov_deg": 60,
//    "width": 1280, "height": 720,
//    "exposure": "auto" or EV (a number),
//    "mode": "full" | "direct" | "indirect",
//    "surface": "textured" | "lighting",        "lighting": every albedo 0.5
//    "background": [0, 0, 0], "lamps": false}
//
// Only "eye" and one of "target" and "direction" are required; unknown keys are errors.
#pragma once
#include <filesystem>
#include <string_view>

#include "render/view.h"

namespace lightwell::render {

/// Throws FileError naming the file, the key and the reason.
View readCamera(const std::filesystem::path& file);
/// The same from text; `file` only names it in errors.
View parseCamera(std::string_view json, const std::string& file);

/// "full", "direct" or "indirect".
const char* partName(LightPart part);

}  // namespace lightwell::render
