#include "precompute/plan/light_paths.h"

#include "precompute/plan/points_json.h"
#include "precompute/plan/settings.h"

namespace lightwell::plan {

std::vector<std::vector<std::array<double, 3>>> readLightPaths(const std::filesystem::path& file) {
  const std::string name = file.string();
  const nlohmann::json document = readPointsDocument(file);
  const scene::JsonValue paths = scene::JsonValue(name, document).at("paths");
  std::vector<std::vector<std::array<double, 3>>> points;
  size_t count = 0;
  for (size_t i = 0; i < paths.size(); ++i) {
    points.push_back(pointsOf(paths[i]));
    if (points.back().empty()) paths[i].fail("has no points");
    count += points.back().size();
  }
  if (count == 0 || count > kMostLightPathPoints) paths.fail("have " + std::to_string(count) + " points together; 1 to " + std::to_string(kMostLightPathPoints) + " can be baked");
  return points;
}

}  // namespace lightwell::plan
