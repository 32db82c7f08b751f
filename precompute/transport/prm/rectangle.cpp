#include "precompute/transport/prm/rectangle.h"

#include <algorithm>
#include <cmath>

namespace lightwell::transport {

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

std::pair<Vec3, Vec3> halfSides(const RectangleShape& shape, double area, const Vec3& tangent, const Vec3& bitangent) {
  const float half_u = float(std::sqrt(0.25 * area * shape.proportion)), half_v = float(std::sqrt(0.25 * area / shape.proportion));
  const float c = float(std::cos(shape.angle)), s = float(std::sin(shape.angle));
  return {(tangent * c + bitangent * s) * half_u, (bitangent * c - tangent * s) * half_v};
}

}  // namespace lightwell::transport
