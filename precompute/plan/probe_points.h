// PROBES.json: {"probes": [[x, y, z], …]}, in metres in the world of the glTF file.
#pragma once
#include <array>
#include <filesystem>
#include <vector>

namespace lightwell::plan {

/// Throws InputError when the file cannot be read, is no such document, or has none or more than kMostProbePoints points.
std::vector<std::array<double, 3>> readProbePoints(const std::filesystem::path& file);

}  // namespace lightwell::plan
