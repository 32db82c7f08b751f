#include "precompute/atlas/grow.h"

#include <algorithm>
#include <numeric>
#include <queue>

#include "precompute/atlas/adjacency.h"
#include "precompute/atlas/coverage.h"
#include "precompute/atlas/planar_cover.h"

namespace lightwell::atlas {
namespace {

constexpr double kSliver = 1e-5;               // height over longest edge below which float corners give no normal
constexpr double kCornerRounding = 4e-6;       // internal units: two floats' rounding at the scene's extent of 16
constexpr size_t kMostPocketTriangles = 12;    // of leftovers between charts
constexpr double kMostPocketShare = 0.1;       // of the area of the chart that takes the pocket in
constexpr double kMostPocketDeviation = 1.2;   // radians

struct Facet {
  std::array<Vec3d, 3> corner;
  Vec3d normal{0, 0, 0}, centroid;
  double area = 0, longest_edge = 0;
  bool sliver = false;
};

Facet facetOf(const scene::Mesh& mesh, uint32_t triangle) {
  Facet facet;
  for (int k = 0; k < 3; ++k) facet.corner[k] = Vec3d(mesh.positions[mesh.triangles[triangle][k]]);
  const auto& [a, b, c] = facet.corner;
  const Vec3d cross = (b - a).cross(c - a);
  const double length = cross.length();
  facet.area = 0.5 * length;
  facet.longest_edge = std::max({(b - a).length(), (c - b).length(), (a - c).length()});
  facet.sliver = length <= kSliver * facet.longest_edge * facet.longest_edge;
  if (length > 0) facet.normal = cross / length;
  facet.centroid = (a + b + c) / 3.0;
  return facet;
}

struct Frame {
  Vec3d origin, x, y;
  Vec2d project(const Vec3d& p) const { return {(p - origin).dot(x), (p - origin).dot(y)}; }
};

Frame frameOf(const Facet& seed) {
  Vec3d n = seed.normal;
  if (n.length2() == 0) n = Vec3d(0, 0, 1);
  Vec3 x, y;
  orthonormalBasis(Vec3(n), x, y);
  Frame frame{seed.centroid, Vec3d(x), {}};
  frame.x = (frame.x - n * n.dot(frame.x)).normalized();
  frame.y = n.cross(frame.x);
  return frame;
}

/// Corners of the convex hull, counter-clockwise. Andrew's monotone chain.
std::vector<Vec2d> convexHull(std::vector<Vec2d> points) {
  const auto less = [](const Vec2d& a, const Vec2d& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; };
  std::sort(points.begin(), points.end(), less);
  std::vector<Vec2d> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const size_t base = hull.size() + 1;
    for (const Vec2d& p : points) {
      while (hull.size() > base && (hull.back() - hull[hull.size() - 2]).cross(p - hull.back()) <= 0) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

/// Turns the chart so that its bounding box has the smallest area (one side of it lies along an edge of the hull; Freeman and
/// Shapira 1975), the longer side along x, and moves it to the origin.
void alignToSmallestBox(Chart& chart) {
  std::vector<Vec2d> points;
  points.reserve(chart.corners.size() * 3);
  for (const auto& corners : chart.corners) points.insert(points.end(), corners.begin(), corners.end());
  std::vector<Vec2d> hull = convexHull(std::move(points));
  constexpr size_t kMostDirections = 256;  // edges tried on a hull with very many
  const size_t step = std::max<size_t>(1, hull.size() / kMostDirections);
  Vec2d best_axis(1, 0);
  double best_area = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < hull.size(); i += step) {
    const Vec2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const double length = edge.length();
    if (!(length > 0)) continue;
    const Vec2d axis = edge / length;
    double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300;
    for (const Vec2d& p : hull) {
      const double x = axis.dot(p), y = axis.cross(p);
      low_x = std::min(low_x, x), high_x = std::max(high_x, x);
      low_y = std::min(low_y, y), high_y = std::max(high_y, y);
    }
    const double area = (high_x - low_x) * (high_y - low_y);
    if (area < best_area * (1 - 1e-9)) {
      best_area = area;
      best_axis = high_x - low_x >= high_y - low_y ? axis : Vec2d(-axis.y, axis.x);
    }
  }
  Vec2d low(1e300, 1e300), high(-1e300, -1e300);
  for (auto& corners : chart.corners)
    for (Vec2d& p : corners) {
      p = Vec2d(best_axis.dot(p), best_axis.cross(p));
      low = Vec2d(std::min(low.x, p.x), std::min(low.y, p.y));
      high = Vec2d(std::max(high.x, p.x), std::max(high.y, p.y));
    }
  for (auto& corners : chart.corners)
    for (Vec2d& p : corners) p -= low;
  chart.extent = high - low;
}

class ChartGrower {
 public:
  ChartGrower(const scene::Mesh& mesh, const scene::Object& object, float normal_deviation)
      : object_(object),
        neighbours_(triangleAdjacency(mesh, object)),
        cos_limit_(std::cos(double(normal_deviation))),
        cos_pocket_limit_(std::min(cos_limit_, std::cos(std::min(1.5 * normal_deviation, kMostPocketDeviation)))),
        facets_(facetsOf(mesh, object)),
        cover_(cellSize(facets_), kCornerRounding),
        chart_of_(object.triangle_count, kNone),
        refused_by_(object.triangle_count, kNone) {}

  std::vector<Chart> run() {
    std::vector<uint32_t> seeds(facets_.size());
    std::iota(seeds.begin(), seeds.end(), 0u);
    std::stable_sort(seeds.begin(), seeds.end(), [&](uint32_t a, uint32_t b) {
      return facets_[a].sliver != facets_[b].sliver ? facets_[b].sliver : facets_[a].area > facets_[b].area;
    });
    std::vector<Chart> charts;
    for (uint32_t seed : seeds) {
      if (chart_of_[seed] != kNone) continue;
      Chart& chart = charts.emplace_back();
      growFrom(seed, uint32_t(charts.size() - 1), chart);
      alignToSmallestBox(chart);
    }
    return charts;
  }

 private:
  struct Candidate {
    double distance2;
    uint32_t facet;
    bool operator>(const Candidate& o) const { return distance2 != o.distance2 ? distance2 > o.distance2 : facet > o.facet; }
  };

  static std::vector<Facet> facetsOf(const scene::Mesh& mesh, const scene::Object& object) {
    std::vector<Facet> facets(object.triangle_count);
    for (uint32_t t = 0; t < object.triangle_count; ++t) facets[t] = facetOf(mesh, object.first_triangle + t);
    return facets;
  }
  /// Bounds the grid cells over all triangles by a small multiple of their number, whatever their sizes and shapes.
  static double cellSize(const std::vector<Facet>& facets) {
    double area = 0, edge = 0;
    for (const Facet& facet : facets) area += facet.area, edge += facet.longest_edge;
    const double count = std::max<double>(1, double(facets.size()));
    return std::max({std::sqrt(area / count), edge / count, 1e-6});
  }

  bool tryAdd(uint32_t t, uint32_t id, const Frame& frame, Chart& chart) {
    PlanarTriangle projected;
    for (int k = 0; k < 3; ++k) projected[k] = frame.project(facets_[t].corner[k]);
    if (!cover_.tryAdd(projected)) return false;
    chart_of_[t] = id;
    chart.triangles.push_back(object_.first_triangle + t);
    chart.corners.push_back(projected);
    return true;
  }

  void growFrom(uint32_t seed, uint32_t id, Chart& chart) {
    const Facet& seed_facet = facets_[seed];
    const Frame frame = frameOf(seed_facet);
    cover_.clear();
    std::vector<uint32_t> border;  // triangles beside the chart whose normals deviate
    double area = 0;
    std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
    queue.push({0, seed});
    while (!queue.empty()) {
      const uint32_t t = queue.top().facet;
      queue.pop();
      if (chart_of_[t] != kNone || refused_by_[t] == id) continue;
      const bool faces = facets_[t].sliver || t == seed || facets_[t].normal.dot(seed_facet.normal) >= cos_limit_;
      if (!faces || !tryAdd(t, id, frame, chart)) {
        refused_by_[t] = id;
        if (!faces) border.push_back(t);
        continue;
      }
      area += facets_[t].area;
      for (uint32_t next : neighbours_[t])
        if (next != kNone && chart_of_[next] == kNone && refused_by_[next] != id)
          queue.push({(facets_[next].centroid - seed_facet.centroid).length2(), next});
    }
    for (uint32_t t : border) absorbPocket(t, id, seed_facet, area, frame, chart);
  }

  /// Takes in the few triangles around `start` that this chart and earlier ones enclose, though they deviate a bit more: each would
  /// be a chart of its own.
  void absorbPocket(uint32_t start, uint32_t id, const Facet& seed_facet, double chart_area, const Frame& frame, Chart& chart) {
    if (chart_of_[start] != kNone) return;
    std::vector<uint32_t> pocket{start};
    double area = 0;
    for (size_t i = 0; i < pocket.size(); ++i) {
      const Facet& facet = facets_[pocket[i]];
      area += facet.area;
      if (!facet.sliver && facet.normal.dot(seed_facet.normal) < cos_pocket_limit_) return;
      for (uint32_t next : neighbours_[pocket[i]]) {
        const bool is_new = next != kNone && chart_of_[next] == kNone && std::find(pocket.begin(), pocket.end(), next) == pocket.end();
        if (is_new) pocket.push_back(next);
      }
      if (pocket.size() > kMostPocketTriangles) return;
    }
    if (area > kMostPocketShare * chart_area) return;
    // In breadth-first order from the chart, so that what is taken stays connected when an overlap stops it.
    for (uint32_t t : pocket)
      if (!tryAdd(t, id, frame, chart)) return;
  }

  const scene::Object& object_;
  std::vector<std::array<uint32_t, 3>> neighbours_;
  double cos_limit_, cos_pocket_limit_;
  std::vector<Facet> facets_;
  PlanarCover cover_;
  std::vector<uint32_t> chart_of_, refused_by_;  // per triangle of the object: chart numbers
};

}  // namespace

std::vector<Chart> growCharts(const scene::Mesh& mesh, const scene::Object& object, float normal_deviation) {
  return ChartGrower(mesh, object, normal_deviation).run();
}

}  // namespace lightwell::atlas
