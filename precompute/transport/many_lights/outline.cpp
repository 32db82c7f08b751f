#include "precompute/transport/many_lights/outline.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

constexpr double kAxesPreferred = 0.98;

double cross(const Vec2& o, const Vec2& a, const Vec2& b) {
  return (double(a.x) - o.x) * (double(b.y) - o.y) - (double(a.y) - o.y) * (double(b.x) - o.x);
}

}  // namespace

Polygon2 convexHull(std::vector<Vec2> points) {
  std::sort(points.begin(), points.end(), [](const Vec2& a, const Vec2& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  Polygon2 hull;
  const auto chain = [&](auto begin, auto end) {
    const size_t first = hull.size();
    for (auto p = begin; p != end; ++p) {
      while (hull.size() >= first + 2 && cross(hull[hull.size() - 2], hull.back(), *p) <= 0) hull.pop_back();
      hull.push_back(*p);
    }
    hull.pop_back();
  };
  chain(points.begin(), points.end());
  chain(points.rbegin(), points.rend());
  return hull;
}

double areaOf(const Polygon2& polygon) {
  double twice = 0;
  for (size_t i = 2; i < polygon.size(); ++i) twice += cross(polygon[0], polygon[i - 1], polygon[i]);
  return twice / 2;
}

Vec2 centroidOf(const Polygon2& polygon) {
  double x = 0, y = 0, twice = 0;
  for (size_t i = 2; i < polygon.size(); ++i) {
    const double part = cross(polygon[0], polygon[i - 1], polygon[i]);
    x += part * (double(polygon[i - 1].x - polygon[0].x) + double(polygon[i].x - polygon[0].x)) / 3;
    y += part * (double(polygon[i - 1].y - polygon[0].y) + double(polygon[i].y - polygon[0].y)) / 3;
    twice += part;
  }
  return twice > 0 ? polygon[0] + Vec2(float(x / twice), float(y / twice)) : polygon[0];
}

Polygon2 simplified(Polygon2 polygon, size_t most) {
  while (polygon.size() > most) {
    size_t least = 0;
    double least_area = INFINITY;
    for (size_t i = 0; i < polygon.size(); ++i) {
      const double area = cross(polygon[(i + polygon.size() - 1) % polygon.size()], polygon[i], polygon[(i + 1) % polygon.size()]);
      if (area < least_area) least = i, least_area = area;
    }
    polygon.erase(polygon.begin() + std::ptrdiff_t(least));
  }
  return polygon;
}

Polygon2 clipped(const Polygon2& polygon, const Vec2& normal, float offset) {
  Polygon2 result;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec2 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
    const float from = normal.dot(a) - offset, to = normal.dot(b) - offset;
    if (from <= 0) result.push_back(a);
    if ((from < 0 && to > 0) || (from > 0 && to < 0)) result.push_back(a + (b - a) * (from / (from - to)));
  }
  return result;
}

Polygon2 grownInto(const Polygon2& cell, const Polygon2& hull, float border) {
  Polygon2 result = cell;
  for (size_t i = 0; i < hull.size(); ++i) {
    const Vec2 edge = hull[(i + 1) % hull.size()] - hull[i];
    const float length = edge.length();
    if (!(length > 0)) continue;
    const Vec2 outward(edge.y / length, -edge.x / length);
    result = clipped(result, outward, outward.dot(hull[i]) + border);
  }
  return result;
}

Vec2 alignment(const Polygon2& hull) {
  Vec2 best(1, 0);
  double best_area = INFINITY;
  for (size_t i = 0; hull.size() >= 3 && i <= hull.size(); ++i) {
    const Vec2 edge = i == 0 ? best : hull[i % hull.size()] - hull[i - 1];
    const float length = edge.length();
    if (!(length > 0)) continue;
    const Vec2 along = edge / length, across(-along.y, along.x);
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (const Vec2& corner : hull)
      for (int k = 0; k < 2; ++k) {
        const double at = (k == 0 ? along : across).dot(corner - hull[0]);
        low[k] = std::min(low[k], at), high[k] = std::max(high[k], at);
      }
    const double area = (high[0] - low[0]) * (high[1] - low[1]);
    if (area < best_area) best = along, best_area = i == 0 ? kAxesPreferred * area : area;
  }
  return best;
}

}  // namespace lightwell::transport
