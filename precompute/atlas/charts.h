// Connected regions of the atlas: within one, neighbouring texels lie side by side on the surface too.
#pragma once
#include "precompute/atlas/atlas.h"

namespace lightwell::atlas {

/// Sets Slot::chart and chart_count. Triangles are connected when they share an edge with equal positions and equal light-map
/// coordinates at both ends; a texel of several charts belongs to the one with the largest area in it. Charts are numbered by their
/// first slot.
void findCharts(const scene::Mesh& mesh, Atlas& atlas);

}  // namespace lightwell::atlas
