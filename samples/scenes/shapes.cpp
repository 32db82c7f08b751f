#include "samples/scenes/shapes.h"

#include <algorithm>

namespace lightwell::samples {
namespace {

Vec3 rounded(const Vec3& v, float steps) {
  return {std::round(v.x * steps) / steps, std::round(v.y * steps) / steps, std::round(v.z * steps) / steps};
}

/// Point k of n around the y axis, in the order that makes outward faces counter-clockwise.
Vec3 around(int k, int n) {
  const float angle = 2 * kPi * float(k % n) / float(n) + kPi / float(n);
  return {std::cos(angle), 0, -std::sin(angle)};
}

}  // namespace

uint32_t Chart::addVertex(const Vec3& position, const Vec3& normal, const Vec2& uv) {
  positions.push_back(rounded(position, 4096));
  normals.push_back(rounded(normal, 16384));
  metric_uv.push_back(uv);
  return uint32_t(positions.size() - 1);
}

uint32_t SampleScene::addMaterial(const std::string& material_name, const Rgb& albedo_rgb, const Rgb& emitted_radiance_rgb) {
  materials.push_back({.name = material_name, .albedo_rgb = albedo_rgb, .emitted_radiance_rgb = emitted_radiance_rgb});
  return uint32_t(materials.size() - 1);
}

size_t SampleScene::triangleCount() const {
  size_t count = 0;
  for (const Node& node : nodes)
    for (const Chart& chart : node.charts) count += chart.triangles.size();
  return count;
}

void addPlanarChart(Node& node, uint32_t material, std::span<const Vec3> corners, size_t corners_per_polygon) {
  const Vec3 normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
  // Axis-aligned planes keep the axes, others follow their first edge: charts then fill their rectangles.
  Vec3 u_axis = (corners[1] - corners[0]).normalized();
  if (std::abs(normal.y) > 0.999f || std::abs(normal.x) > 0.999f || std::abs(normal.z) > 0.999f)
    u_axis = std::abs(normal.x) > 0.999f ? Vec3(0, 0, 1) : Vec3(1, 0, 0);
  const Vec3 v_axis = normal.cross(u_axis);
  Chart chart;
  chart.material = material;
  for (size_t first = 0; first < corners.size(); first += corners_per_polygon) {
    const uint32_t base = uint32_t(chart.positions.size());
    for (size_t i = 0; i < corners_per_polygon; ++i) {
      const Vec3& p = corners[first + i];
      chart.addVertex(p, normal, {p.dot(u_axis), p.dot(v_axis)});
    }
    for (uint32_t i = 2; i < corners_per_polygon; ++i) chart.triangles.push_back({base, base + i - 1, base + i});
  }
  node.charts.push_back(std::move(chart));
}

void addPolygon(Node& node, uint32_t material, std::span<const Vec3> corners) {
  addPlanarChart(node, material, corners, corners.size());
}

void addQuad(Node& node, uint32_t material, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  addPolygon(node, material, std::array{a, b, c, d});
}

void addBox(Node& node, uint32_t material, const Vec3& center, const Vec3& size, float angle, bool with_bottom) {
  const float cosine = std::cos(angle), sine = std::sin(angle);
  const auto corner = [&](float x, float y, float z) {
    const float dx = x * size.x / 2, dz = z * size.z / 2;
    return center + Vec3(cosine * dx + sine * dz, y * size.y / 2, cosine * dz - sine * dx);
  };
  const float ring[5][2] = {{-1, 1}, {1, 1}, {1, -1}, {-1, -1}, {-1, 1}};
  for (int side = 0; side < 4; ++side) {
    const auto* a = ring[side];
    const auto* b = ring[side + 1];
    addQuad(node, material, corner(a[0], -1, a[1]), corner(b[0], -1, b[1]), corner(b[0], 1, b[1]), corner(a[0], 1, a[1]));
  }
  addQuad(node, material, corner(-1, 1, 1), corner(1, 1, 1), corner(1, 1, -1), corner(-1, 1, -1));
  if (with_bottom) addQuad(node, material, corner(-1, -1, -1), corner(1, -1, -1), corner(1, -1, 1), corner(-1, -1, 1));
}

void addOpenBox(Node& node, uint32_t material, const Vec3& min, const Vec3& max) {
  addBox(node, material, (min + max) * 0.5f, max - min, 0, false);
}

void addLathe(Node& node, uint32_t material, const Vec3& foot, std::span<const ProfilePoint> profile, int segments) {
  Chart chart;
  chart.material = material;
  float widest = 0, along = 0;
  for (const ProfilePoint& point : profile) widest = std::max(widest, point.radius_m);
  const int columns = segments + 1;
  for (size_t ring = 0; ring < profile.size(); ++ring) {
    const ProfilePoint& here = profile[ring];
    const ProfilePoint& below = profile[ring > 0 ? ring - 1 : 0];
    const ProfilePoint& above = profile[std::min(ring + 1, profile.size() - 1)];
    along += std::hypot(here.radius_m - below.radius_m, here.height_m - below.height_m);
    const float rise = above.height_m - below.height_m, run = above.radius_m - below.radius_m;
    const float length = std::hypot(rise, run);
    for (int k = 0; k < columns; ++k) {
      const Vec3 outward = around(k, segments);
      const Vec3 normal = (outward * rise - Vec3(0, run, 0)) / length;
      const float circumference = 2 * kPi * widest * float(k) / float(segments);
      chart.addVertex(foot + outward * here.radius_m + Vec3(0, here.height_m, 0), normal, {circumference, along});
    }
  }
  for (size_t ring = 0; ring + 1 < profile.size(); ++ring)
    for (int k = 0; k < segments; ++k) {
      const uint32_t a = uint32_t(ring) * columns + k, b = a + 1, c = b + columns, d = a + columns;
      if (profile[ring].radius_m > 0) chart.triangles.push_back({a, b, c});
      if (profile[ring + 1].radius_m > 0) chart.triangles.push_back({a, c, d});
    }
  node.charts.push_back(std::move(chart));
}

void addSphere(Node& node, uint32_t material, const Vec3& center, float radius_m, int segments, int rings) {
  std::vector<ProfilePoint> profile;
  for (int ring = 0; ring <= rings; ++ring) {
    const float angle = kPi * float(ring) / float(rings);
    const bool pole = ring == 0 || ring == rings;
    profile.push_back({pole ? 0.0f : radius_m * std::sin(angle), -radius_m * std::cos(angle)});
  }
  addLathe(node, material, center, profile, segments);
}

void addHoledPlate(Node& node, uint32_t material, const Vec3& center, float half_width_m, float hole_radius_m, int segments, bool up) {
  // Each side of the hole reaches to the square's rim; where its two rays meet different sides, the corner lies between.
  std::vector<Vec3> quads;
  const auto rim = [&](const Vec3& direction) {
    return direction * (half_width_m / std::max(std::abs(direction.x), std::abs(direction.z)));
  };
  for (int k = 0; k < segments; ++k) {
    const Vec3 from = around(k, segments), to = around(k + 1, segments);
    const Vec3 rim_from = rim(from), rim_to = rim(to);
    const Vec3 inner_from = from * hole_radius_m, inner_to = to * hole_radius_m;
    const bool same_side = std::abs(rim_from.x - rim_to.x) < 1e-5f || std::abs(rim_from.z - rim_to.z) < 1e-5f;
    const Vec3 corner(std::copysign(half_width_m, rim_from.x + rim_to.x), 0, std::copysign(half_width_m, rim_from.z + rim_to.z));
    const Vec3 outline[5] = {inner_from, rim_from, corner, rim_to, inner_to};
    const auto emit = [&](std::array<int, 3> t) {
      if (!up) std::swap(t[1], t[2]);
      for (int i : t) quads.push_back(center + outline[i]);
    };
    if (same_side) {
      emit({0, 1, 3});
    } else {
      emit({0, 1, 2});
      emit({0, 2, 3});
    }
    emit({0, 3, 4});
  }
  addPlanarChart(node, material, quads, 3);
}

void addColumn(Node& node, uint32_t stone, uint32_t plate, const Column& column) {
  const float r = column.radius_m, height = column.soffit_m - column.plinth_top.y;
  const ProfilePoint base[] = {{1.26f * r, 0}, {1.3f * r, 0.3f * r}, {r, 0.62f * r}};
  const ProfilePoint shaft[] = {{r, 0.62f * r}, {0.84f * r, height - 1.25f * r}};
  const ProfilePoint capital[] = {{0.84f * r, height - 1.25f * r}, {0.96f * r, height - 0.65f * r}, {1.32f * r, height}};
  addLathe(node, stone, column.plinth_top, base, column.segments);
  addLathe(node, stone, column.plinth_top, shaft, column.segments);
  addLathe(node, stone, column.plinth_top, capital, column.segments);
  addHoledPlate(node, stone, column.plinth_top, column.half_width_m, base[0].radius_m, column.segments, true);
  const Vec3 soffit(column.plinth_top.x, column.soffit_m, column.plinth_top.z);
  addHoledPlate(node, plate, soffit, column.half_width_m, capital[2].radius_m, column.segments, false);
}

void addSheet(Node& node, uint32_t material, int columns, int rows, const std::function<Vec3(float, float)>& point) {
  Chart chart;
  chart.material = material;
  const float step = 1.0f / 256;
  for (int row = 0; row <= rows; ++row) {
    float along_m = 0;
    for (int column = 0; column <= columns; ++column) {
      const float s = float(column) / float(columns), t = float(row) / float(rows);
      const Vec3 p = point(s, t);
      if (column > 0) along_m += (p - point(float(column - 1) / float(columns), t)).length();
      const Vec3 normal = (point(s + step, t) - point(s - step, t)).cross(point(s, t + step) - point(s, t - step)).normalized();
      chart.addVertex(p, normal, {along_m, t * (point(s, 1) - point(s, 0)).length()});
    }
  }
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const uint32_t a = row * (columns + 1) + column, b = a + 1, c = b + columns + 1, d = a + columns + 1;
      chart.triangles.push_back({a, b, c});
      chart.triangles.push_back({a, c, d});
    }
  node.charts.push_back(std::move(chart));
}

}  // namespace lightwell::samples
