// Pieces of a plane that are rectangles.
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::transport {

struct Point2 {
  double x = 0, y = 0;
};

struct RectangleShape {
  double angle = 0;       // of the first side, from the x axis
  double proportion = 1;  // first side / second side
};

/// Of the rectangle of least area about the points (one of its sides lies along their convex hull: Freeman, Shapira, "Determining the Minimum-Area Encasing
/// Rectangle for an Arbitrary Closed Curve"); nothing where it is more than a fiftieth larger than `area`: the piece is no rectangle then. Sorts `points`.
std::optional<RectangleShape> rectangleAround(std::vector<Point2>& points, double area);

/// Half the sides of the rectangle of this shape and area, in the plane that tangent and bitangent span (unit, perpendicular).
std::pair<Vec3, Vec3> halfSides(const RectangleShape& shape, double area, const Vec3& tangent, const Vec3& bitangent);

}  // namespace lightwell::transport
