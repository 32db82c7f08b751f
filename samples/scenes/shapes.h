// The solids that the sample scenes are made of. Each call appends charts to a node.
#pragma once
#include <functional>
#include <span>

#include "samples/scenes/sample_scene.h"

namespace lightwell::samples {

/// One corner of the outline that a lathe turns about the y axis.
struct ProfilePoint {
  float radius_m, height_m;
};

/// A planar polygon given counter-clockwise from the front; convex.
void addPolygon(Node& node, uint32_t material, std::span<const Vec3> corners);
void addQuad(Node& node, uint32_t material, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Several coplanar convex polygons as one chart: polygon i holds `corners_per_polygon` consecutive corners.
void addPlanarChart(Node& node, uint32_t material, std::span<const Vec3> corners, size_t corners_per_polygon);

/// A box without its bottom, which is meant to stand on something.
void addOpenBox(Node& node, uint32_t material, const Vec3& min, const Vec3& max);
/// All six faces of a box, turned by `angle` about the vertical through its centre.
void addBox(Node& node, uint32_t material, const Vec3& center, const Vec3& size, float angle, bool with_bottom);

/// A smooth surface of revolution about the vertical through `foot`. The profile runs from bottom to top; outside is to its right.
void addLathe(Node& node, uint32_t material, const Vec3& foot, std::span<const ProfilePoint> profile, int segments);
void addSphere(Node& node, uint32_t material, const Vec3& center, float radius_m, int segments, int rings);

/// A square plate in the plane y = `center.y` with the hole of a `segments`-gon in it; `up` says which way it faces.
void addHoledPlate(Node& node, uint32_t material, const Vec3& center, float half_width_m, float hole_radius_m, int segments, bool up);

/// A column from its square plinth (whose top it makes) to a soffit (of which it makes the square above the capital).
struct Column {
  Vec3 plinth_top;       // centre of the plinth's top
  float soffit_m;        // height of the underside that it carries
  float half_width_m;    // of plinth and soffit square
  float radius_m;        // of the shaft at the bottom
  int segments = 10;
};
void addColumn(Node& node, uint32_t stone, uint32_t plate, const Column& column);

/// A smooth sheet over a rectangle of parameters: point(s, t) for s, t in [0, 1]; front where ds × dt points.
void addSheet(Node& node, uint32_t material, int columns, int rows, const std::function<Vec3(float, float)>& point);

}  // namespace lightwell::samples
