// Charts of a mesh without light-map coordinates: connected triangles that face one way and do not cover each other when projected.
#pragma once
#include <functional>
#include <span>
#include <vector>

#include "precompute/atlas/plane.h"
#include "precompute/scene/scene.h"

namespace lightwell::atlas {

/// A generated chart: triangles and their corners in the plane (internal units), turned so that the bounding box is smallest and starts at
/// the origin. The projection is orthogonal, so a plane chart keeps its lengths.
struct Chart {
  std::vector<uint32_t> triangles;
  std::vector<PlanarTriangle> corners;  // per triangle
  Vec2d extent{0, 0};                   // of the bounding box; the longer side first
};

/// Cuts the triangles of `object` into charts. A chart grows from its largest triangle to the nearest connected ones (vertices at
/// one position are one) while their normals stay within `normal_deviation` (radians) of the seed's and the projections along it do
/// not overlap. A few triangles left over between charts may deviate by half more; slivers, whose normals mean nothing, join any
/// chart. Deterministic.
std::vector<Chart> growCharts(const scene::Mesh& mesh, const scene::Object& object, float normal_deviation);

/// The charts of the listed objects (indices into Scene::objects), one list each, in their order: what growCharts() gives, wherever it
/// was computed.
using ChartSource =
    std::function<std::vector<std::vector<Chart>>(const scene::Scene& scene, std::span<const size_t> objects, float normal_deviation)>;

}  // namespace lightwell::atlas
