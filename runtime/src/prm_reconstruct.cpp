#include "runtime/src/prm_reconstruct.h"

#include "format/decode/pixel.h"
#include "runtime/src/prm_tile.h"

namespace lightwell::runtime {
namespace {

constexpr uint32_t kMostRank = 255;  // checked when loaded

/// Adds a constant pane, times a factor per channel; nothing where there is no such pane.
void addConstant(const Array<uint32_t>& pane_rgb9e5, const float* factor_rgb, uint32_t first, uint32_t end, float* values_rgba) {
  if (pane_rgb9e5.empty()) return;
  for (uint32_t i = first; i < end; ++i, values_rgba += 4) {
    const format::Float3 e = format::unpackRgb9e5(pane_rgb9e5[i]);
    values_rgba[0] = sane(values_rgba[0] + e.x * factor_rgb[0]);
    values_rgba[1] = sane(values_rgba[1] + e.y * factor_rgb[1]);
    values_rgba[2] = sane(values_rgba[2] + e.z * factor_rgb[2]);
  }
}

}  // namespace

void reconstruct(const lw_prm& prm, uint32_t block, uint32_t first, uint32_t end, const int8_t* basis, const float* sums, float* values_rgba) {
  const uint32_t rank = prm.block_rank[block];
  Float4 amount_rgb[kMostRank];
  for (uint32_t k = 0; k < rank; ++k) {
    const float *sum = sums + k * 3, *scale = prm.links.scale(block) + k * 3;
    amount_rgb[k] = Float4{sum[0] * scale[0], sum[1] * scale[1], sum[2] * scale[2], 0} * basisValue(1);
  }
  if (!reconstructTileAvx2(amount_rgb, rank, basis, end - first, values_rgba)) reconstructTile(amount_rgb, rank, basis, end - first, values_rgba);
}

void packHalfs(const float* values_rgba, uint32_t count, uint16_t* halfs_rgba) {
  if (!packTileAvx2(values_rgba, count, halfs_rgba)) packTile(values_rgba, count, halfs_rgba);
}

void addConstants(const lw_prm& prm, const lw_prm_options& options, uint32_t first, uint32_t end, float* values_rgba) {
  const float once[3] = {1, 1, 1}, scale = prm.header.sky_scale;
  const float sky_rgb[3] = {options.sky_rgb[0] * scale, options.sky_rgb[1] * scale, options.sky_rgb[2] * scale};
  if (options.emitters & LW_EMITTERS_DIRECT) addConstant(prm.emitter_direct_rgb9e5, once, first, end, values_rgba);
  if (options.emitters & LW_EMITTERS_INDIRECT) addConstant(prm.emitter_indirect_rgb9e5, once, first, end, values_rgba);
  if (options.emitters & LW_SKY_DIRECT) addConstant(prm.sky_direct_rgb9e5, sky_rgb, first, end, values_rgba);
  if (options.emitters & LW_SKY_INDIRECT) addConstant(prm.sky_indirect_rgb9e5, sky_rgb, first, end, values_rgba);
}

}  // namespace lightwell::runtime
