// The surface under the texels of the atlas, found anew from the geometry: by exact cutting, so that no texel that a triangle touches is missed, be it by its centre or by the rules of a rasteriser.
#pragma once
#include "runtime/src/container.h"

namespace lightwell::runtime {

struct TexelSurface {
  uint32_t width = 0, height = 0;
  Array<uint32_t> value_of_texel;  // [height * width]: which value a texel shows, or kNone
  Array<float> place;              // [values][4]: mean position in metres, half the side of a square of the surface's area
  Array<float> normal;             // [values][4]: octahedral mean of the shading normal, then of the surface's own normal
  Array<uint16_t> axes;            // [values][2][4], halves: two vectors along the surface, xyz over place[3]: points of it have the covariance of a a' + b b'.
                                   // The first's w: how far the surface stands out of their plane, to both sides, where it is curved or folded
  uint32_t values() const { return uint32_t(place.size() / 4); }
};

/// With `fill` a value for each texel that some texel shows, and each texel shows its source's; else one for each covered texel, which none but itself shows.
/// Decodes sections geometry and atlas, and fails as that does.
lw_result findTexelSurface(const lw_container& container, bool fill, TexelSurface& surface);

}  // namespace lightwell::runtime
