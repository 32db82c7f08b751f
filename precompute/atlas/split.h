// Duplicates vertices along the seams of generated charts.
#pragma once
#include <vector>

#include "precompute/atlas/grow.h"
#include "precompute/atlas/pack.h"

namespace lightwell::atlas {

/// The charts generated for one object and their places; no charts: the object keeps its coordinates.
struct ObjectCharts {
  std::vector<Chart> charts;
  std::vector<Placement> placements;
};

/// Gives every vertex its coordinates in an atlas of size × size texels: those of its chart, or TEXCOORD_1 clamped to [0, 1]. A
/// vertex of several charts is duplicated, within the vertex range of its object; triangles and objects of `scene` are updated.
/// Vertices of no triangle get (0, 0).
std::vector<Vec2> splitAlongSeams(scene::Scene& scene, const std::vector<ObjectCharts>& objects, int size);

}  // namespace lightwell::atlas
