// Which triangles of an object share an edge, by position alone: splits of normals and texture coordinates do not part them.
#pragma once
#include <array>
#include <vector>

#include "precompute/scene/scene.h"

namespace lightwell::atlas {

/// Per triangle of the object (index from first_triangle) the triangle beyond edge k (corners k and k + 1), or kNone. Edges with more
/// than two triangles link them in a ring, so every one of them is reached.
std::vector<std::array<uint32_t, 3>> triangleAdjacency(const scene::Mesh& mesh, const scene::Object& object);

}  // namespace lightwell::atlas
