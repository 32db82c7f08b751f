// The section "points": surface points for shadow maps of lights that move.
#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"
#include "precompute/bake/sections.h"

namespace lightwell::bake {

void addPointsSection(format::Writer& writer, const transport::SurfacePoints& surface, const scene::Scene& scene) {
  const double metres = scene.metres_per_unit;
  const uint64_t points = surface.points.size();
  v1::PointsHeader header;
  header.set_points(uint32_t(points));
  header.set_area(float(surface.area * metres * metres));
  double first[3], step[3];
  for (int k = 0; k < 3; ++k) {
    first[k] = double(scene.bounds.min[k]) * metres;
    step[k] = double(scene.bounds.max[k] - scene.bounds.min[k]) * metres / 65535;
    header.add_first(float(first[k]));
    header.add_step(float(step[k]));
  }
  std::vector<uint16_t> position;
  std::vector<int16_t> normal;
  std::vector<uint32_t> texel;
  for (const transport::SurfacePoint& point : surface.points) {
    for (int k = 0; k < 3; ++k)
      position.push_back(step[k] > 0 ? uint16_t(std::clamp(std::round((double(point.position[k]) * metres - first[k]) / step[k]), 0.0, 65535.0)) : 0);
    const auto oct = format::packOct({point.normal.x, point.normal.y, point.normal.z});
    normal.push_back(oct.x), normal.push_back(oct.y);
    texel.push_back(point.texel);
  }
  writer.addSection("points");
  writer.addMessage("points", "header", header);
  writer.add("points", "position", position, {points, 3});
  writer.add("points", "normal", normal, {points, 2});
  writer.add("points", "texel", texel);
}

}  // namespace lightwell::bake
