#include "runtime/src/prm_reconstruct.h"

#include "format/decode/pixel.h"

namespace lightwell::runtime {
namespace {

constexpr uint32_t kMostRank = 255;  // checked when loaded

/// Adds a constant pane, times a factor per channel; nothing where there is no such pane.
void addConstant(const lw_prm& prm, const Array<uint32_t>& pane_rgb9e5, const float* factor_rgb, uint32_t first, uint32_t end, float* atlas_rgba) {
  if (pane_rgb9e5.empty()) return;
  for (uint32_t i = first; i < end; ++i) {
    const format::Float3 e = format::unpackRgb9e5(pane_rgb9e5[i]);
    float* texel = atlas_rgba + size_t(prm.texel[i]) * 4;
    texel[0] = sane(texel[0] + e.x * factor_rgb[0]);
    texel[1] = sane(texel[1] + e.y * factor_rgb[1]);
    texel[2] = sane(texel[2] + e.z * factor_rgb[2]);
  }
}

}  // namespace

const int8_t* reconstructBlock(const lw_prm& prm, uint32_t block, const int8_t* basis, const float* sums, float* atlas_rgba) {
  const uint32_t rank = prm.block_rank[block];
  float amount_rgb[kMostRank * 3];
  for (uint32_t i = 0; i < rank * 3; ++i) amount_rgb[i] = sums[i] * prm.links.scale(block)[i];
  for (uint32_t t = prm.block_first_texel[block]; t < prm.block_first_texel[block + 1]; ++t, basis += rank) {
    float sum[3] = {};
    for (uint32_t k = 0; k < rank; ++k) {
      const float value = basisValue(basis[k]);
      for (int c = 0; c < 3; ++c) sum[c] += value * amount_rgb[k * 3 + c];
    }
    float* texel = atlas_rgba + size_t(prm.texel[t]) * 4;
    for (int c = 0; c < 3; ++c) texel[c] = sane(sum[c]);
    texel[3] = 1.0f;
  }
  return basis;
}

void addConstants(const lw_prm& prm, const lw_prm_options& options, uint32_t first, uint32_t end, float* atlas_rgba) {
  const float once[3] = {1, 1, 1}, scale = prm.header.sky_scale;
  const float sky_rgb[3] = {options.sky_rgb[0] * scale, options.sky_rgb[1] * scale, options.sky_rgb[2] * scale};
  if (options.emitters & LW_EMITTERS_DIRECT) addConstant(prm, prm.emitter_direct_rgb9e5, once, first, end, atlas_rgba);
  if (options.emitters & LW_EMITTERS_INDIRECT) addConstant(prm, prm.emitter_indirect_rgb9e5, once, first, end, atlas_rgba);
  if (options.emitters & LW_SKY_DIRECT) addConstant(prm, prm.sky_direct_rgb9e5, sky_rgb, first, end, atlas_rgba);
  if (options.emitters & LW_SKY_INDIRECT) addConstant(prm, prm.sky_indirect_rgb9e5, sky_rgb, first, end, atlas_rgba);
}

}  // namespace lightwell::runtime
