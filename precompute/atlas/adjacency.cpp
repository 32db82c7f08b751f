#include "precompute/atlas/adjacency.h"

#include <algorithm>
#include <tuple>

#include "precompute/atlas/weld.h"

namespace lightwell::atlas {
namespace {

struct Edge {
  uint32_t a, b;      // welded vertices, a < b
  uint32_t triangle;  // of the object
  uint32_t side;
};

}  // namespace

std::vector<std::array<uint32_t, 3>> triangleAdjacency(const scene::Mesh& mesh, const scene::Object& object) {
  const std::vector<uint32_t> welded = weld(object.vertex_count, [&](uint32_t i) {
    const Vec3& p = mesh.positions[object.first_vertex + i];
    return std::tie(p.x, p.y, p.z);
  });
  std::vector<Edge> edges;
  edges.reserve(size_t(object.triangle_count) * 3);
  for (uint32_t t = 0; t < object.triangle_count; ++t) {
    const auto& triangle = mesh.triangles[object.first_triangle + t];
    for (uint32_t k = 0; k < 3; ++k) {
      uint32_t a = welded[triangle[k] - object.first_vertex], b = welded[triangle[(k + 1) % 3] - object.first_vertex];
      if (a == b) continue;
      if (a > b) std::swap(a, b);
      edges.push_back({a, b, t, k});
    }
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
    return std::tie(l.a, l.b, l.triangle, l.side) < std::tie(r.a, r.b, r.triangle, r.side);
  });
  std::vector<std::array<uint32_t, 3>> neighbour(object.triangle_count, {kNone, kNone, kNone});
  for (size_t first = 0; first < edges.size();) {
    size_t end = first;
    while (end < edges.size() && edges[end].a == edges[first].a && edges[end].b == edges[first].b) ++end;
    if (end - first > 1)
      for (size_t i = first; i < end; ++i)
        neighbour[edges[i].triangle][edges[i].side] = edges[i + 1 == end ? first : i + 1].triangle;
    first = end;
  }
  return neighbour;
}

}  // namespace lightwell::atlas
