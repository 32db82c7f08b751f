// PATHS.json: {"paths": [[[x, y, z], …], …]}: where lights move, in metres in the world of the glTF file. A path of one point is a place.
#pragma once
#include <array>
#include <filesystem>
#include <vector>

namespace lightwell::plan {

/// Throws InputError when the file cannot be read, is no such document, or has none or more than kMostLightPathPoints points.
std::vector<std::vector<std::array<double, 3>>> readLightPaths(const std::filesystem::path& file);

}  // namespace lightwell::plan
