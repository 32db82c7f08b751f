// A sample scene as a binary glTF 2.0 file.
#pragma once
#include <filesystem>
#include <vector>

#include "samples/scenes/sample_scene.h"

namespace lightwell::samples {

/// The bytes of a .glb: one mesh per node, one primitive per material, POSITION, NORMAL, TEXCOORD_0 (metres) and, when the scene has a
/// layout, TEXCOORD_1; lamps as KHR_lights_punctual. The same scene gives the same bytes.
std::vector<uint8_t> encodeGlb(const SampleScene& scene);
void writeFile(const std::filesystem::path& file, const std::vector<uint8_t>& bytes);

}  // namespace lightwell::samples
