#include "precompute/plan/probe_points.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "precompute/plan/settings.h"
#include "precompute/scene/gltf/files.h"
#include "precompute/scene/json_value.h"

namespace lightwell::plan {
namespace {

constexpr uint64_t kMostBytes = 64ull << 20;
constexpr double kFarthest_m = 1e9;

}  // namespace

std::vector<std::array<double, 3>> readProbePoints(const std::filesystem::path& file) {
  const std::string name = file.string();
  const std::vector<uint8_t> bytes = scene::gltf::readFile(file, kMostBytes);
  const nlohmann::json document = scene::parseJson(name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  const scene::JsonValue probes = scene::JsonValue(name, document).at("probes");
  if (probes.size() == 0 || probes.size() > kMostProbePoints) probes.fail("has " + std::to_string(probes.size()) + " points; 1 to " + std::to_string(kMostProbePoints) + " can be baked");
  std::vector<std::array<double, 3>> points;
  for (size_t i = 0; i < probes.size(); ++i) {
    points.push_back(probes[i].numbers<3>());
    for (const double coordinate : points.back())
      if (!(std::abs(coordinate) <= kFarthest_m)) probes[i].fail("is farther away than 1e9 m");
  }
  return points;
}

}  // namespace lightwell::plan
