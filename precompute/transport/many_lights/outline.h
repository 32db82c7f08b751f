// Convex outlines of points in a plane: what a virtual polygon light is made of.
#pragma once
#include <span>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

using Polygon2 = std::vector<Vec2>;  // convex, counter-clockwise

/// Andrew's monotone chain; without collinear corners. Fewer than three corners when the points span no area.
Polygon2 convexHull(std::vector<Vec2> points);
double areaOf(const Polygon2& polygon);
Vec2 centroidOf(const Polygon2& polygon);
/// Leaves out the corners that change the area least until there are at most `most`.
Polygon2 simplified(Polygon2 polygon, size_t most);
/// The part where normal · p ≤ offset.
Polygon2 clipped(const Polygon2& polygon, const Vec2& normal, float offset);
/// `cell` as far as it lies within `border` of each edge's line of `hull`.
Polygon2 grownInto(const Polygon2& cell, const Polygon2& hull, float border);
/// Direction of the side of the least rectangle around the hull; (1, 0) when it has no area, or that is nearly as good: hulls of random
/// points are never quite straight.
Vec2 alignment(const Polygon2& hull);

}  // namespace lightwell::transport
