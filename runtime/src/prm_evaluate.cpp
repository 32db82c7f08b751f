// The weighted sum of panes, or of local bases: irradiance at every texel of the atlas, from light alone.
#include <algorithm>
#include <cfloat>
#include <cmath>
#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/container.h"
#include "runtime/src/prm.h"
#include "runtime/src/prm_reconstruct.h"

namespace lightwell::runtime {

bool isIrradiance(const float* values, size_t count) {
  uint32_t good = 0;  // a sum of numbers becomes one of vectors
  for (size_t i = 0; i < count; ++i) good += uint32_t(values[i] >= 0.0f) & uint32_t(values[i] <= FLT_MAX);
  return good == uint32_t(count);
}

bool resolveOptions(const lw_prm_options* given, lw_prm_options& options) {
  options = LW_PRM_OPTIONS_INIT;
  if (!given) return true;
  if (given->size < sizeof(lw_prm_options) || given->keep_energy > 1 || given->fill > 1 ||
      given->emitters > (LW_EMITTERS_DIRECT | LW_EMITTERS_INDIRECT | LW_SKY_DIRECT | LW_SKY_INDIRECT) || !isIrradiance(given->sky_rgb, 3) ||
      !(given->tolerance >= 0 && given->tolerance <= 1))
    return false;
  options = *given;
  return true;
}

namespace {

/// What a chosen cluster is weighted with.
struct Weight {
  float contribution;
  uint32_t cluster;
};

/// The clusters to sum, in ascending order, and the scale that keeps the energy of those left out. Returns their number.
uint32_t selectBrightest(const lw_prm& prm, const float* irradiance_rgb, uint32_t brightest, bool keep_energy, Weight* weights,
                         float* scale_rgb) {
  const uint32_t clusters = prm.header.clusters;
  const float* pane_sum = prm.pane_sum_rgb.data();
  uint32_t lit = 0;
  for (uint32_t c = 0; c < clusters; ++c) {
    const float* e = irradiance_rgb + size_t(c) * 3;
    if (e[0] > 0 || e[1] > 0 || e[2] > 0) weights[lit++] = {contribution(e, pane_sum + size_t(c) * 3), c};
  }
  std::fill_n(scale_rgb, 3, 1.0f);
  if (!brightest || brightest >= lit) return lit;
  std::nth_element(weights, weights + brightest, weights + lit, [](const Weight& a, const Weight& b) {
    return a.contribution > b.contribution || (a.contribution == b.contribution && a.cluster < b.cluster);
  });
  std::sort(weights, weights + brightest, [](const Weight& a, const Weight& b) { return a.cluster < b.cluster; });
  if (keep_energy) {
    double all[3] = {}, kept[3] = {};
    for (size_t i = 0; i < size_t(clusters) * 3; ++i) all[i % 3] += double(irradiance_rgb[i]) * pane_sum[i];
    for (uint32_t w = 0; w < brightest; ++w)
      for (int k = 0; k < 3; ++k)
        kept[k] += double(irradiance_rgb[size_t(weights[w].cluster) * 3 + k]) * pane_sum[size_t(weights[w].cluster) * 3 + k];
    for (int k = 0; k < 3; ++k)
      if (kept[k] > 0) scale_rgb[k] = float(all[k] / kept[k]);
  }
  return brightest;
}

void addPane(const uint32_t* pane, uint32_t texels, const float* irradiance_rgb, float* r, float* g, float* b) {
  for (uint32_t i = 0; i < texels; ++i) {
    const format::Float3 v = format::unpackRgb9e5(pane[i]);
    r[i] += v.x * irradiance_rgb[0];
    g[i] += v.y * irradiance_rgb[1];
    b[i] += v.z * irradiance_rgb[2];
  }
}

/// Finite halfs only (checked when loaded): shifting exponent and mantissa into place and rescaling by 2^112 is exact, subnormals included.
inline float unpackFiniteHalf(uint32_t h) {
  return std::bit_cast<float>((h & 0x7fffu) << 13) * 0x1p112f * (h & 0x8000u ? -1.0f : 1.0f);
}

void addPane(const uint16_t* pane, uint32_t texels, const float* irradiance_rgb, float* r, float* g, float* b) {
  for (uint32_t i = 0; i < texels; ++i) {
    r[i] += unpackFiniteHalf(pane[i * 3]) * irradiance_rgb[0];
    g[i] += unpackFiniteHalf(pane[i * 3 + 1]) * irradiance_rgb[1];
    b[i] += unpackFiniteHalf(pane[i * 3 + 2]) * irradiance_rgb[2];
  }
}

/// Values to their texels.
void scatter(const lw_prm& prm, uint32_t first, uint32_t end, const float* values_rgba, float* atlas_rgba) {
  for (uint32_t i = first; i < end; ++i) std::memcpy(atlas_rgba + size_t(prm.texel[i]) * 4, values_rgba + (i - first) * 4, 4 * sizeof(float));
}

/// A tile of texels at a time, so that the sums stay in the first-level cache while panes stream past.
void evaluatePanes(const lw_prm& prm, const lw_prm_options& options, const float* irradiance_rgb, const Weight* weights, uint32_t weight_count,
                   const float* scale_rgb, float* rgba) {
  const uint32_t texels = prm.header.texels;
  for (uint32_t first = 0; first < texels; first += kTileTexels) {
    const uint32_t count = std::min(kTileTexels, texels - first);
    float r[kTileTexels] = {}, g[kTileTexels] = {}, b[kTileTexels] = {}, values_rgba[kTileTexels * 4];
    for (uint32_t w = 0; w < weight_count; ++w) {
      const size_t cluster = weights[w].cluster, value = cluster * texels + first;
      if (prm.pane_half.empty()) addPane(&prm.pane_rgb9e5[value], count, irradiance_rgb + cluster * 3, r, g, b);
      else addPane(&prm.pane_half[value * 3], count, irradiance_rgb + cluster * 3, r, g, b);
    }
    for (uint32_t i = 0; i < count; ++i) {
      float* value = values_rgba + i * 4;
      value[0] = sane(r[i] * scale_rgb[0]);
      value[1] = sane(g[i] * scale_rgb[1]);
      value[2] = sane(b[i] * scale_rgb[2]);
      value[3] = 1.0f;
    }
    addConstants(prm, options, first, first + count, values_rgba);
    scatter(prm, first, first + count, values_rgba, rgba);
  }
}

void evaluateLocalBases(const lw_prm& prm, const lw_prm_options& options, const float* irradiance_rgb, float* scratch, float* rgba) {
  const int8_t* basis = prm.basis.data();
  SumMemory memory(prm, scratch);
  memory.clear(prm);
  prm.tree.transform(irradiance_rgb, memory.wavelet_rgb);
  prm.links.update(memory.change(), options.tolerance);
  for (uint32_t block = 0; block < prm.header.blocks; ++block)
    basis = showBlock(prm, options, block, basis, memory.sums + block * prm.links.stride(),
                      [&](uint32_t first, uint32_t end, const float* values_rgba) { scatter(prm, first, end, values_rgba, rgba); });
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

size_t lw_prm_scratch_bytes(const lw_prm* prm) {
  if (!prm) return 0;
  return prm->pane_sum_rgb.empty() ? SumMemory::floats(*prm) * sizeof(float) : size_t(prm->header.clusters) * sizeof(Weight);
}

lw_result lw_prm_evaluate(const lw_prm* prm, const float* cluster_irradiance_rgb, const lw_prm_options* given, void* scratch,
                          size_t scratch_bytes, float* atlas_rgba) {
  if (!prm || !cluster_irradiance_rgb || !atlas_rgba) return LW_INVALID_ARGUMENT;
  lw_prm_options options;
  if (!resolveOptions(given, options)) return prm->host.fail(LW_INVALID_ARGUMENT, "lw_prm_options: a value is out of range");
  const size_t needed = lw_prm_scratch_bytes(prm);
  if (scratch_bytes < needed || (needed && !scratch))
    return prm->host.fail(LW_INVALID_ARGUMENT, "%zu bytes of scratch are needed, not %zu", needed, scratch_bytes);
  if (!isIrradiance(cluster_irradiance_rgb, size_t(prm->header.clusters) * 3))
    return prm->host.fail(LW_INVALID_ARGUMENT, "an irradiance is negative or not finite");
  std::memset(atlas_rgba, 0, prm->source.size() * 4 * sizeof(float));
  if (!prm->pane_sum_rgb.empty()) {
    auto* weights = static_cast<Weight*>(scratch);
    float scale_rgb[3];
    const uint32_t count = selectBrightest(*prm, cluster_irradiance_rgb, options.brightest, options.keep_energy != 0, weights, scale_rgb);
    evaluatePanes(*prm, options, cluster_irradiance_rgb, weights, count, scale_rgb, atlas_rgba);
  } else {
    evaluateLocalBases(*prm, options, cluster_irradiance_rgb, static_cast<float*>(scratch), atlas_rgba);
  }
  if (options.fill) fillFromSources(prm->source.data(), prm->source.size(), atlas_rgba);
  return LW_OK;
}
