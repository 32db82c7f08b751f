#include "precompute/atlas/charts.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include "precompute/atlas/weld.h"

namespace lightwell::atlas {
namespace {

class DisjointSets {
 public:
  explicit DisjointSets(size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(uint32_t a, uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<uint32_t> parent_;
};

struct Edge {
  uint32_t a, b, triangle;  // a < b
  bool sameAs(const Edge& o) const { return a == o.a && b == o.b; }
};

}  // namespace

void findCharts(const scene::Mesh& mesh, Atlas& atlas) {
  const std::vector<uint32_t> welded = weld(atlas.uv.size(), [&](uint32_t i) {
    const Vec2& uv = atlas.uv[i];
    const Vec3& p = mesh.positions[i];
    return std::tie(uv.x, uv.y, p.x, p.y, p.z);
  });
  std::vector<Edge> edges;
  edges.reserve(mesh.triangles.size() * 3);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const uint32_t a = welded[mesh.triangles[t][k]], b = welded[mesh.triangles[t][(k + 1) % 3]];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), t});
    }
  std::sort(edges.begin(), edges.end(), [](const Edge& l, const Edge& r) {
    return std::tie(l.a, l.b, l.triangle) < std::tie(r.a, r.b, r.triangle);
  });
  DisjointSets sets(mesh.triangles.size());
  for (size_t i = 1; i < edges.size(); ++i)
    if (edges[i].sameAs(edges[i - 1])) sets.unite(edges[i].triangle, edges[i - 1].triangle);

  std::vector<uint32_t> number(mesh.triangles.size(), kNone);  // of each set's first triangle
  std::vector<std::pair<uint32_t, double>> shares;             // chart's first triangle, area in the texel
  atlas.chart_count = 0;
  for (Slot& slot : atlas.slots) {
    shares.clear();
    for (uint32_t i = 0; i < slot.patch_count; ++i) {
      const Patch& patch = atlas.patches[slot.first_patch + i];
      shares.push_back({sets.find(patch.triangle), patch.area});
    }
    std::stable_sort(shares.begin(), shares.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    uint32_t largest = shares[0].first;
    double most = -1;
    for (size_t first = 0; first < shares.size();) {
      double area = 0;
      size_t end = first;
      for (; end < shares.size() && shares[end].first == shares[first].first; ++end) area += shares[end].second;
      if (area > most) most = area, largest = shares[first].first;
      first = end;
    }
    if (number[largest] == kNone) number[largest] = atlas.chart_count++;
    slot.chart = number[largest];
  }
}

}  // namespace lightwell::atlas
