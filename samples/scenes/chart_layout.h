// From charts in metres to a light-map layout, and from shapes that touch to a conforming mesh.
#pragma once
#include "samples/scenes/sample_scene.h"

namespace lightwell::samples {

/// Splits triangles of a node at every vertex of the node that lies inside one of their edges, so that faces that touch share whole
/// edges, then welds equal vertices within each chart.
void stitch(Node& node);

/// Lays all charts out in [0, 1]² for an atlas of `size` texels: the greatest uniform density at which they fit, `padding_texels` free
/// texels between charts. Chart borders lie on texel centres, so that bilinear lookup never leaves a chart. Returns texels per metre.
float layOutCharts(SampleScene& scene, int size, int padding_texels);

}  // namespace lightwell::samples
