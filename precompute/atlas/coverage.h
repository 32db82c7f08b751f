// Which pieces of which triangles lie in which texel: exact coverage by polygon clipping.
#pragma once
#include "format/decode/texels.h"
#include "precompute/atlas/atlas.h"

namespace lightwell::atlas {

using format::CellRange, format::ClipPolygon, format::ClipVertex, format::clipToCells;

/// The corners of `triangle` in texels of a width × height grid, clamped to it. Corners that miss a texel border by no more than the
/// rounding of a float UV are put on it, so that charts laid out on the grid do not touch the next texel by rounding.
void cornersInTexels(const scene::Mesh& mesh, const std::vector<Vec2>& uv, uint32_t triangle, int width, int height,
                              ClipVertex (&corner)[3]);

/// Area of a triangle, internal units², in double; never zero, so that every triangle owns a patch.
double triangleArea(const scene::Mesh& mesh, uint32_t triangle);

/// Fills `patches`, `slots` (texel, patches, area), `texel_slot` and `triangle_slot` of `atlas` from its `uv`, width and height.
/// Every triangle gets at least one patch, also one that is a point or a segment in UV space: that one lies whole in the texels it touches.
void buildCoverage(const scene::Mesh& mesh, Atlas& atlas);

}  // namespace lightwell::atlas
