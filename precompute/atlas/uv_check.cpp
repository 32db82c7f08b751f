#include "precompute/atlas/uv_check.h"

#include <algorithm>
#include <cmath>

#include "precompute/atlas/coverage.h"

namespace lightwell::atlas {
namespace {

constexpr float kRangeTolerance = 1e-3f;     // UV units; exporters overshoot by their own rounding
constexpr double kCollapsedUvArea = 1e-12;   // UV units²: a triangle without extent in UV space
constexpr double kCollapsedShare = 0.5;      // of an object's area
constexpr double kOverlapShare = 0.01;       // of an object's UV area …
constexpr double kOverlapTexels = 2;         // … and at least so many texels' area

double uvArea(const scene::Mesh& mesh, uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const auto& uv = mesh.lightmap_uv;
  const double x1 = double(uv[b].x) - uv[a].x, y1 = double(uv[b].y) - uv[a].y;
  const double x2 = double(uv[c].x) - uv[a].x, y2 = double(uv[c].y) - uv[a].y;
  return 0.5 * std::abs(x1 * y2 - x2 * y1);
}

/// What can be told from the coordinates alone.
UvProblem checkValues(const scene::Mesh& mesh, const scene::Object& object, double& area) {
  if (mesh.lightmap_uv.empty() || !object.has_lightmap_uv) return UvProblem::missing;
  bool out_of_range = false;
  double collapsed_area = 0;
  for (uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
    for (uint32_t vertex : mesh.triangles[t]) {
      const Vec2& uv = mesh.lightmap_uv[vertex];
      if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) return UvProblem::not_finite;
      out_of_range |= std::min(uv.x, uv.y) < -kRangeTolerance || std::max(uv.x, uv.y) > 1 + kRangeTolerance;
    }
    const double triangle_area = triangleArea(mesh, t);
    area += triangle_area;
    if (uvArea(mesh, t) < kCollapsedUvArea) collapsed_area += triangle_area;
  }
  if (out_of_range) return UvProblem::out_of_range;
  return collapsed_area > kCollapsedShare * area ? UvProblem::collapsed : UvProblem::none;
}

/// Area that one object's triangles put on the texels, in texels.
class ObjectCover {
 public:
  explicit ObjectCover(size_t texels) : area_(texels, 0.0f) {}

  void add(const scene::Mesh& mesh, const scene::Object& object, int width, int height) {
    for (uint32_t t = object.first_triangle; t < object.first_triangle + object.triangle_count; ++t) {
      ClipVertex corner[3];
      cornersInTexels(mesh, mesh.lightmap_uv, t, width, height, corner);
      clipToCells(corner, {0, width, 0, height}, [&](long x, long y, const ClipPolygon& piece) {
        const float piece_area = float(piece.gridArea());
        if (!(piece_area > 0)) return;
        const uint32_t texel = uint32_t(y) * uint32_t(width) + uint32_t(x);
        if (area_[texel] == 0) touched_.push_back(texel);
        area_[texel] += piece_area;
      });
    }
  }
  void clear() {
    for (uint32_t texel : touched_) area_[texel] = 0;
    touched_.clear();
  }
  const std::vector<uint32_t>& touched() const { return touched_; }
  float operator[](uint32_t texel) const { return area_[texel]; }

 private:
  std::vector<float> area_;
  std::vector<uint32_t> touched_;
};

}  // namespace

const char* describe(UvProblem problem) {
  switch (problem) {
    case UvProblem::none: return "sound";
    case UvProblem::missing: return "missing";
    case UvProblem::not_finite: return "not finite";
    case UvProblem::out_of_range: return "outside [0, 1]";
    case UvProblem::collapsed: return "collapsed to points or lines";
    case UvProblem::overlaps_itself: return "overlapping itself";
    case UvProblem::overlaps_another: return "overlapping that of another object";
  }
  return "unsound";
}

UvCheck checkLightmapUv(const scene::Scene& scene, int width, int height) {
  const scene::Mesh& mesh = scene.mesh;
  UvCheck check;
  check.problem.resize(scene.objects.size(), UvProblem::none);
  check.occupied.assign(size_t(width) * height, 0.0f);
  ObjectCover cover(check.occupied.size());
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const scene::Object& object = scene.objects[i];
    double area = 0;
    check.problem[i] = checkValues(mesh, object, area);
    if (check.problem[i] != UvProblem::none) continue;

    cover.add(mesh, object, width, height);
    double uv_area = 0, own_excess = 0, shared_excess = 0;
    for (uint32_t texel : cover.touched()) {
      const float own = cover[texel];
      uv_area += own;
      own_excess += std::max(0.0f, own - 1.0f);
      shared_excess += std::max(0.0f, std::min(own, 1.0f) + check.occupied[texel] - 1.0f);
    }
    const double allowed = std::max(kOverlapTexels, kOverlapShare * uv_area);
    if (own_excess > allowed) check.problem[i] = UvProblem::overlaps_itself;
    else if (shared_excess > allowed) check.problem[i] = UvProblem::overlaps_another;
    if (check.problem[i] == UvProblem::none) {
      // A triangle without UV area still has the texel it lies in; epsilon marks it.
      for (uint32_t texel : cover.touched()) check.occupied[texel] = std::min(1.0f, check.occupied[texel] + std::max(cover[texel], 1e-6f));
      check.sound_uv_area_texels += uv_area;
      check.sound_area += area;
    }
    cover.clear();
  }
  return check;
}

}  // namespace lightwell::atlas
