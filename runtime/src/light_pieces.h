// Virtual lights as they are drawn: copied, checked, and the large ones cut into pieces.
#pragma once
#include "runtime/src/form_factor.h"
#include "runtime/src/host.h"

namespace lightwell::runtime {

/// A virtual light or a part of one; form factors of the parts of a polygon add up to its own exactly.
struct LightPiece {
  uint32_t type, vertex_count;
  bool cuttable;                // polygons, until cutting would leave too many corners
  Float3 position_m, normal;
  float flux_rgb[3];
  float radius_m, area_m2;      // as in lw_virtual_light
  float reach_m;                // of its points from position_m, at most
  Float3 vertex_m[kMostPolygonVertices];
};

/// Null, or what is wrong with the numbers.
const char* checkVirtualLight(const lw_virtual_light& light);
LightPiece wholeLight(const lw_virtual_light& light);
/// Cuts polygons in two, across their longest way, where luminance × reach is largest, until there are `most` pieces or none can be cut. pieces[0, count) are given; the array
/// has room for `most`. Returns how many there are.
uint32_t cutLights(LightPiece* pieces, uint32_t count, uint32_t most);
/// The light as the runtime's public functions take it; it lives as long as the piece.
lw_virtual_light publicLight(const LightPiece& piece);

/// The i-th of `count` in an order whose every beginning is spread evenly over all: radical inverses of two (van der Corput). `next` is the state, 0 at first.
uint32_t nextSpread(uint32_t& next, uint32_t count);

}  // namespace lightwell::runtime
