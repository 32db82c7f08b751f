// Places charts of uniform texel density in rectangles of the atlas.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "precompute/atlas/plane.h"

namespace lightwell::atlas {

/// A rectangle of texels.
struct TexelRect {
  int x = 0, y = 0, width = 0, height = 0;
};

/// Where each chart goes: a rectangle of whole texels that its bounding box is stretched to fill. A chart of less than about a
/// texel is collapsed into the centre of one texel: bilinear lookup there reads that texel alone, so such texels lie side by side
/// without padding.
struct Placement {
  TexelRect rect;
  bool collapsed = false;
};

struct Packing {
  std::vector<Placement> placements;  // one per chart
  double texels_per_unit = 0;
};

/// Packs charts with bounding boxes `extents` (internal units, longer side first) into `bins`, at least `padding` texels apart and
/// that far from the right and lower border of each bin, with the highest density up to `most_texels_per_unit` that fits (skyline
/// packing; found to 1 %). Empty when not even one texel a chart fits.
std::optional<Packing> packCharts(std::span<const Vec2d> extents, std::span<const TexelRect> bins, int padding,
                                  double most_texels_per_unit);

/// The bin that stands for a whole atlas: the padding of the last charts may reach over its right and lower border.
inline TexelRect wholeAtlas(int size, int padding) { return {0, 0, size + padding, size + padding}; }

/// The smallest size of a square atlas that has room for `charts` charts of one texel each; above `limit`: limit + 1.
int smallestAtlas(size_t charts, int padding, int limit);

/// Disjoint empty rectangles of a width × height grid, largest first, in which packCharts may place charts beside the texels with
/// occupied > 0: they leave `padding` texels to the right of those and below; to their left and above it is packCharts that does.
std::vector<TexelRect> freeRectangles(const std::vector<float>& occupied, int width, int height, int padding);

}  // namespace lightwell::atlas
