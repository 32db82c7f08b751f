#include "precompute/plan/probe_points.h"

#include "precompute/plan/points_json.h"
#include "precompute/plan/settings.h"

namespace lightwell::plan {

std::vector<std::array<double, 3>> readProbePoints(const std::filesystem::path& file) {
  const std::string name = file.string();
  const nlohmann::json document = readPointsDocument(file);
  const scene::JsonValue probes = scene::JsonValue(name, document).at("probes");
  if (probes.size() == 0 || probes.size() > kMostProbePoints) probes.fail("has " + std::to_string(probes.size()) + " points; 1 to " + std::to_string(kMostProbePoints) + " can be baked");
  return pointsOf(probes);
}

}  // namespace lightwell::plan
