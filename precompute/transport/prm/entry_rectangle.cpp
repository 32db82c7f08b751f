#include "precompute/transport/prm/entry_rectangle.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace lightwell::transport {
namespace {

struct Point2 {
  double x = 0, y = 0;
};

struct RectangleShape {
  double angle = 0;       // of the first side, from the tangent
  double proportion = 1;  // first side / second side
};

/// Of the rectangle of least area about the points (one of its sides lies along their convex hull: Freeman, Shapira, "Determining the Minimum-Area Encasing
/// Rectangle for an Arbitrary Closed Curve"); nothing where it is more than a fiftieth larger than `area`: the piece is no rectangle then.
std::optional<RectangleShape> rectangleAround(std::vector<Point2>& points, double area) {
  std::sort(points.begin(), points.end(), [](const Point2& a, const Point2& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  const auto turn = [](const Point2& a, const Point2& b, const Point2& c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); };
  std::vector<Point2> hull;  // monotone chain
  for (const bool upper : {false, true}) {
    const size_t first = hull.size();
    const auto add = [&](const Point2& point) {
      while (hull.size() >= first + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 0) hull.pop_back();
      hull.push_back(point);
    };
    if (upper) std::for_each(points.rbegin(), points.rend(), add);
    else std::for_each(points.begin(), points.end(), add);
    hull.pop_back();
  }
  constexpr double kMostSlack = 1.02;
  double least = kMostSlack * area;
  std::optional<RectangleShape> shape;
  for (size_t i = 0; i < hull.size(); ++i) {
    const Point2 &from = hull[i], &to = hull[(i + 1) % hull.size()];
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    if (!(length > 0)) continue;
    const double c = (to.x - from.x) / length, s = (to.y - from.y) / length;
    double along_low = HUGE_VAL, along_high = -HUGE_VAL, across_low = HUGE_VAL, across_high = -HUGE_VAL;
    for (const Point2& p : hull) {
      const double along = c * p.x + s * p.y, across = c * p.y - s * p.x;
      along_low = std::min(along_low, along), along_high = std::max(along_high, along);
      across_low = std::min(across_low, across), across_high = std::max(across_high, across);
    }
    const double width = along_high - along_low, height = across_high - across_low;
    if (!(width * height < least * (1 - 1e-9)) || !(height > 0)) continue;
    least = width * height;
    shape = {std::atan2(s, c), width / height};
  }
  return shape;
}

}  // namespace

void appendRectangle(std::span<const SurfacePiece> pieces, const Vec3& centroid, float area, PrmEntries& entries) {
  Vec3 tangent, bitangent;
  orthonormalBasis(entries.normal.back(), tangent, bitangent);
  double uu = 0, uv = 0, vv = 0;
  std::vector<Point2> outline;
  for (const auto& piece : pieces) {
    // A triangle's moment about a point: that of its mean point, and the spread of its corners about that, a twelfth of the sum of squares.
    const auto add = [&](const Vec3& offset, double weight) {
      const double u = offset.dot(tangent), v = offset.dot(bitangent);
      uu += weight * u * u, uv += weight * u * v, vv += weight * v * v;
    };
    add(piece.centroid - centroid, piece.area);
    for (const auto& corner : piece.corner) {
      add(corner - piece.centroid, double(piece.area) / 12);
      outline.push_back({(corner - centroid).dot(tangent), (corner - centroid).dot(bitangent)});
    }
  }
  const double middle = 0.5 * (uu + vv), spread = std::hypot(0.5 * (uu - vv), uv);
  const double least = std::max(1e-4 * (middle + spread), middle - spread);  // slivers stay rectangles
  RectangleShape shape{0.5 * std::atan2(2 * uv, uu - vv), least > 0 ? std::sqrt((middle + spread) / least) : 1.0};
  if (const auto rectangle = rectangleAround(outline, area)) shape = *rectangle;
  const float half_u = float(std::sqrt(0.25 * area * shape.proportion)), half_v = float(std::sqrt(0.25 * area / shape.proportion));
  const float c = float(std::cos(shape.angle)), s = float(std::sin(shape.angle));
  entries.half_u.push_back((tangent * c + bitangent * s) * half_u);
  entries.half_v.push_back((bitangent * c - tangent * s) * half_v);
}

}  // namespace lightwell::transport
