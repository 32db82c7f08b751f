#include "precompute/atlas/split.h"

#include <algorithm>
#include <cmath>

namespace lightwell::atlas {
namespace {

/// Kept between a chart and the border of its texels, so that float UVs do not round over it.
constexpr double kInsetTexels = 1.0 / 64;

Vec2 placedUv(const Chart& chart, const Placement& placement, const Vec2d& p, int size) {
  const TexelRect& rect = placement.rect;
  const auto along = [&](double coordinate, double extent, int first, int length) {
    if (placement.collapsed || !(extent > 0)) return first + 0.5 * length;
    return first + kInsetTexels + (length - 2 * kInsetTexels) * std::clamp(coordinate / extent, 0.0, 1.0);
  };
  return Vec2(float(along(p.x, chart.extent.x, rect.x, rect.width) / size), float(along(p.y, chart.extent.y, rect.y, rect.height) / size));
}

template <class T>
void gather(std::vector<T>& attribute, const std::vector<uint32_t>& source) {
  if (attribute.empty()) return;
  std::vector<T> result(source.size());
  for (size_t i = 0; i < source.size(); ++i) result[i] = attribute[source[i]];
  attribute = std::move(result);
}

}  // namespace

std::vector<Vec2> splitAlongSeams(scene::Scene& scene, const std::vector<ObjectCharts>& objects, int size) {
  scene::Mesh& mesh = scene.mesh;
  std::vector<uint32_t> source;  // per new vertex: the old one
  std::vector<Vec2> uv;
  source.reserve(mesh.positions.size());
  uv.reserve(mesh.positions.size());
  std::vector<uint32_t> new_vertex(mesh.positions.size(), kNone);  // of each old vertex: its latest copy
  std::vector<uint32_t> owner(mesh.positions.size(), kNone);       // the chart of that copy
  uint32_t chart_id = 0;
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    scene::Object& object = scene.objects[i];
    const uint32_t first = uint32_t(source.size());
    for (uint32_t v = object.first_vertex; v < object.first_vertex + object.vertex_count; ++v) {
      new_vertex[v] = uint32_t(source.size());
      source.push_back(v);
      const bool keeps = objects[i].charts.empty() && !mesh.lightmap_uv.empty();
      Vec2 given = keeps ? mesh.lightmap_uv[v] : Vec2(0, 0);
      if (!std::isfinite(given.x + given.y)) given = Vec2(0, 0);
      uv.push_back(Vec2(std::clamp(given.x, 0.0f, 1.0f), std::clamp(given.y, 0.0f, 1.0f)));
    }
    if (objects[i].charts.empty()) {
      for (uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t)
        for (uint32_t& v : mesh.triangles[t]) v = new_vertex[v];
    }
    for (size_t c = 0; c < objects[i].charts.size(); ++c, ++chart_id) {
      const Chart& chart = objects[i].charts[c];
      for (size_t t = 0; t < chart.triangles.size(); ++t)
        for (int k = 0; k < 3; ++k) {
          uint32_t& v = mesh.triangles[chart.triangles[t]][k];
          if (owner[v] != chart_id) {
            if (owner[v] != kNone) {
              new_vertex[v] = uint32_t(source.size());
              source.push_back(v);
              uv.push_back({});
            }
            owner[v] = chart_id;
            uv[new_vertex[v]] = placedUv(chart, objects[i].placements[c], chart.corners[t][k], size);
          }
          v = new_vertex[v];
        }
    }
    object.first_vertex = first;
    object.vertex_count = uint32_t(source.size()) - first;
  }
  gather(mesh.positions, source);
  gather(mesh.normals, source);
  gather(mesh.base_uv, source);
  gather(mesh.emissive_uv, source);
  gather(mesh.lightmap_uv, source);
  gather(mesh.colors, source);
  return uv;
}

}  // namespace lightwell::atlas
