// Points in files beside a scene.
#pragma once
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "precompute/scene/gltf/files.h"
#include "precompute/scene/json_value.h"

namespace lightwell::plan {

/// Throws InputError.
inline nlohmann::json readPointsDocument(const std::filesystem::path& file) {
  constexpr uint64_t kMostBytes = 64ull << 20;
  const std::vector<uint8_t> bytes = scene::gltf::readFile(file, kMostBytes);
  return scene::parseJson(file.string(), {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// Of an array of three numbers each, metres. Throws InputError.
inline std::vector<std::array<double, 3>> pointsOf(const scene::JsonValue& array) {
  constexpr double kFarthest_m = 1e9;
  std::vector<std::array<double, 3>> points;
  for (size_t i = 0; i < array.size(); ++i) {
    points.push_back(array[i].numbers<3>());
    for (const double coordinate : points.back())
      if (!(std::abs(coordinate) <= kFarthest_m)) array[i].fail("is farther away than 1e9 m");
  }
  return points;
}

}  // namespace lightwell::plan
