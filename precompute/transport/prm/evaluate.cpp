#include "precompute/transport/prm/evaluate.h"

#include <algorithm>
#include <numeric>

namespace lightwell::transport {
namespace {

std::vector<Rgb> evaluatePanes(const PrmResult& prm, std::span<const Rgb> cluster_irradiance_rgb, uint32_t brightest) {
  const size_t texels = prm.texel.size(), clusters = cluster_irradiance_rgb.size();
  std::vector<uint32_t> chosen(clusters);
  std::iota(chosen.begin(), chosen.end(), 0u);
  Rgb scale(1.0f);
  if (brightest > 0 && brightest < clusters) {
    // A pane's energy: its mean, which is what it adds to the whole map.
    std::vector<Imath::V3d> energy(clusters, Imath::V3d(0.0));
    for (size_t c = 0; c < clusters; ++c)
      for (size_t t = 0; t < texels; ++t)
        for (int channel = 0; channel < 3; ++channel)
          energy[c][channel] += double(prm.panes.irradiance_rgb[c * texels + t][channel]) * cluster_irradiance_rgb[c][channel];
    const auto strength = [&](uint32_t c) { return luminance(cluster_irradiance_rgb[c]); };
    std::stable_sort(chosen.begin(), chosen.end(), [&](uint32_t a, uint32_t b) { return strength(a) > strength(b); });
    chosen.resize(brightest);
    Imath::V3d all(0.0), kept(0.0);
    for (const auto& value : energy) all += value;
    for (const uint32_t c : chosen) kept += energy[c];
    for (int channel = 0; channel < 3; ++channel) scale[channel] = kept[channel] > 0 ? float(all[channel] / kept[channel]) : 1.0f;
  }
  std::vector<Rgb> result(texels, Rgb(0.0f));
  for (const uint32_t c : chosen)
    for (size_t t = 0; t < texels; ++t) result[t] += prm.panes.irradiance_rgb[c * texels + t] * cluster_irradiance_rgb[c] * scale;
  return result;
}

std::vector<Rgb> evaluateLocalBases(const PrmResult& prm, std::span<const Rgb> cluster_irradiance_rgb) {
  const auto& bases = prm.bases;
  std::vector<float> value(cluster_irradiance_rgb.size() * 3);
  for (size_t i = 0; i < value.size(); ++i) value[i] = cluster_irradiance_rgb[i / 3][int(i % 3)];
  value = toWavelets(bases.tree, bases.tree.children(uint32_t(cluster_irradiance_rgb.size())), 3, value);
  std::vector<Rgb> result(prm.texel.size(), Rgb(0.0f));
  size_t basis = 0, coefficient = 0, scale = 0;
  for (size_t block = 0; block < bases.block_rank.size(); ++block) {
    const size_t rank = bases.block_rank[block];
    std::vector<Rgb> amount(rank, Rgb(0.0f));
    for (uint32_t link = bases.block_first_link[block]; link < bases.block_first_link[block + 1]; ++link) {
      const uint32_t wavelet = bases.link_wavelet[link];
      const float per_unit = 1.0f / waveletUnit(bases.wavelet_unit[wavelet]);
      for (size_t k = 0; k < rank; ++k)
        for (int channel = 0; channel < 3; ++channel)
          amount[k][channel] += float(bases.coefficient[coefficient++]) * value[size_t(wavelet) * 3 + size_t(channel)] * per_unit;
    }
    for (size_t k = 0; k < rank; ++k, scale += 3) amount[k] *= Rgb(bases.scale[scale], bases.scale[scale + 1], bases.scale[scale + 2]) / 127.0f;
    for (uint32_t t = bases.block_first_texel[block]; t < bases.block_first_texel[block + 1]; ++t)
      for (size_t k = 0; k < rank; ++k) result[t] += amount[k] * float(bases.basis[basis++]);
  }
  for (auto& value_rgb : result)
    for (int channel = 0; channel < 3; ++channel) value_rgb[channel] = std::max(0.0f, value_rgb[channel]);
  return result;
}

}  // namespace

std::vector<Rgb> evaluatePrm(const PrmResult& prm, std::span<const Rgb> cluster_irradiance_rgb, uint32_t brightest) {
  return prm.bases.block_rank.empty() ? evaluatePanes(prm, cluster_irradiance_rgb, brightest) : evaluateLocalBases(prm, cluster_irradiance_rgb);
}

}  // namespace lightwell::transport
