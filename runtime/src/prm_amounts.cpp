// Local bases: from light on the clusters to the amounts of the blocks' basis maps. The inner loop of a frame on the CPU.
#include <iterator>

#include "runtime/src/prm.h"

namespace lightwell::runtime {
namespace {

/// The rows of a block of this rank over its links: known at compile time, the products of a link become a few vector instructions.
template <uint32_t rank>
void sumLinks(const uint32_t* link, uint32_t links, const int8_t* coefficient, const float* wavelet_rgb, uint32_t, float* amount_rgb) {
  constexpr uint32_t kWidth = rank * 3;
  float sum[kWidth] = {};
  for (uint32_t l = 0; l < links; ++l, coefficient += kWidth) {
    const float* w = wavelet_rgb + size_t(link[l]) * 3;
    if (w[0] == 0 && w[1] == 0 && w[2] == 0) continue;
    float repeated_rgb[kWidth];
    for (uint32_t i = 0; i < kWidth; ++i) repeated_rgb[i] = w[i % 3];
    for (uint32_t i = 0; i < kWidth; ++i) sum[i] += float(coefficient[i]) * repeated_rgb[i];
  }
  for (uint32_t i = 0; i < kWidth; ++i) amount_rgb[i] = sum[i];
}

void sumLinksOfAnyRank(const uint32_t* link, uint32_t links, const int8_t* coefficient, const float* wavelet_rgb, uint32_t rank, float* amount_rgb) {
  for (uint32_t i = 0; i < rank * 3; ++i) amount_rgb[i] = 0;
  for (uint32_t l = 0; l < links; ++l)
    for (uint32_t i = 0; i < rank * 3; ++i) amount_rgb[i] += float(*coefficient++) * wavelet_rgb[size_t(link[l]) * 3 + i % 3];
}

}  // namespace

size_t amountScratchFloats(const lw_prm& prm) { return prm.tree.wavelets() * 3 + prm.coefficient_scale.size() * 3; }

const float* amounts(const lw_prm& prm, const float* cluster_rgb, float* scratch) {
  constexpr decltype(&sumLinksOfAnyRank) kOfRank[] = {sumLinksOfAnyRank, sumLinks<1>, sumLinks<2>, sumLinks<3>, sumLinks<4>,
                                                      sumLinks<5>,       sumLinks<6>, sumLinks<7>, sumLinks<8>};
  float *wavelet_rgb = scratch, *amount_rgb = scratch + prm.tree.wavelets() * 3, *to = amount_rgb;
  prm.tree.transform(cluster_rgb, wavelet_rgb);
  const int8_t* coefficient = prm.coefficient.data();
  const float* scale = prm.coefficient_scale.data();
  for (uint32_t block = 0; block < prm.header.blocks; ++block) {
    const uint32_t rank = prm.block_rank[block], first = prm.block_first_link[block], links = prm.block_first_link[block + 1] - first;
    (rank < std::size(kOfRank) ? kOfRank[rank] : sumLinksOfAnyRank)(prm.link_wavelet.data() + first, links, coefficient, wavelet_rgb, rank, to);
    coefficient += size_t(links) * rank * 3;
    for (uint32_t k = 0; k < rank; ++k, ++scale, to += 3)
      for (uint32_t c = 0; c < 3; ++c) to[c] *= *scale;
  }
  return amount_rgb;
}

}  // namespace lightwell::runtime
