// From a block's sums to its texels, and what does not depend on the lights.
#pragma once
#include <algorithm>
#include <cfloat>

#include "runtime/src/prm.h"

namespace lightwell::runtime {

/// Irradiance that may be shown: finite, not negative.
inline float sane(float v) { return v > 0.0f ? std::min(v, FLT_MAX) : 0.0f; }

/// Values are made a tile at a time, contiguously, before they go to where the atlas shows them.
inline constexpr uint32_t kTileTexels = 256;

/// The values [first, end) of a block, at most a tile: [end - first][4], alpha 1. `basis`: the maps of `first`. `sums`: [rank][3].
void reconstruct(const lw_prm& prm, uint32_t block, uint32_t first, uint32_t end, const int8_t* basis, const float* sums, float* values_rgba);

/// Adds emitters and sky, as options ask, to the values [first, end).
void addConstants(const lw_prm& prm, const lw_prm_options& options, uint32_t first, uint32_t end, float* values_rgba);

/// To the nearest half, ties to even; above 65504 values become that. Both [count][4].
void packHalfs(const float* values_rgba, uint32_t count, uint16_t* halfs_rgba);

/// Calls show(first, end, values_rgba) for the tiles of a block, all light included. Returns where the next block's maps are.
template <class Show>
const int8_t* showBlock(const lw_prm& prm, const lw_prm_options& options, uint32_t block, const int8_t* basis, const float* sums, Show show) {
  float values_rgba[kTileTexels * 4];
  const uint32_t end = prm.block_first_texel[block + 1];
  for (uint32_t first = prm.block_first_texel[block]; first < end; first += kTileTexels) {
    const uint32_t tile_end = std::min(first + kTileTexels, end);
    reconstruct(prm, block, first, tile_end, basis, sums, values_rgba);
    addConstants(prm, options, first, tile_end, values_rgba);
    show(first, tile_end, values_rgba);
    basis += size_t(tile_end - first) * prm.block_rank[block];
  }
  return basis;
}

}  // namespace lightwell::runtime
