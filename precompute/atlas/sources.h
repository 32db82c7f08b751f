// Which texel's value each texel shows: fills buried texels and gutters.
#pragma once
#include <vector>

#include "precompute/atlas/atlas.h"

namespace lightwell::atlas {

/// Gutters are filled this far from the surface, in texels.
inline constexpr int kGutterTexels = 8;

/// Rewrites Atlas::source. `valid`: per slot, whether its own value may be shown. Invalid slots show the nearest valid texel of
/// their chart, or themselves in a chart without one; their number is returned. Uncovered texels within kGutterTexels show what the
/// nearest covered texel shows.
uint32_t fillSources(Atlas& atlas, const std::vector<uint8_t>& valid);

}  // namespace lightwell::atlas
