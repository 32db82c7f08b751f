// Local bases: from light on the clusters to the amounts of the blocks' basis maps. The inner loop of a frame on the CPU.
#include <cstring>

#include "runtime/src/prm.h"

#if defined(__x86_64__) && defined(__GNUC__)
#define LIGHTWELL_AVX2 1
#endif

namespace lightwell::runtime {
namespace {

/// Eight coefficients or products at once; compilers make of it what the machine has.
typedef int8_t Bytes8 [[gnu::vector_size(8)]];
typedef int32_t Ints8 [[gnu::vector_size(32)]];
typedef float Floats8 [[gnu::vector_size(32)]];

/// The row of a block over its links, `vectors` × 8 ≥ 3 × rank numbers wide. Lanes beyond the row read on into the next, and are not used.
template <uint32_t vectors>
[[gnu::always_inline]] inline void sumLinks(const uint32_t* link, uint32_t links, const int8_t* coefficient, const float* wavelet_rgb, uint32_t rank,
                                            float* amount_rgb) {
  Floats8 sum[vectors] = {};
  for (uint32_t l = 0; l < links; ++l, coefficient += rank * 3) {
    const float* w = wavelet_rgb + size_t(link[l]) * 3;
    const float r = w[0], g = w[1], b = w[2];
    if (r == 0 && g == 0 && b == 0) continue;
    const auto add = [&](Floats8& to, const int8_t* from, const Floats8& light) {
      Bytes8 bytes;
      std::memcpy(&bytes, from, sizeof bytes);
      to += __builtin_convertvector(__builtin_convertvector(bytes, Ints8), Floats8) * light;
    };
    add(sum[0], coefficient, Floats8{r, g, b, r, g, b, r, g});
    if constexpr (vectors > 1) add(sum[1], coefficient + 8, Floats8{b, r, g, b, r, g, b, r});
    if constexpr (vectors > 2) add(sum[2], coefficient + 16, Floats8{g, b, r, g, b, r, g, b});
  }
  float all[vectors * 8];
  std::memcpy(all, sum, sizeof all);
  std::memcpy(amount_rgb, all, rank * 3 * sizeof(float));
}

void sumLinksOfAnyRank(const uint32_t* link, uint32_t links, const int8_t* coefficient, const float* wavelet_rgb, uint32_t rank, float* amount_rgb) {
  for (uint32_t i = 0; i < rank * 3; ++i) amount_rgb[i] = 0;
  for (uint32_t l = 0; l < links; ++l)
    for (uint32_t i = 0; i < rank * 3; ++i) amount_rgb[i] += float(*coefficient++) * wavelet_rgb[size_t(link[l]) * 3 + i % 3];
}

[[gnu::always_inline]] inline void sumBlocks(const lw_prm& prm, const float* wavelet_rgb, float* to) {
  const int8_t* coefficient = prm.coefficient.data();
  const float* scale = prm.coefficient_scale.data();
  for (uint32_t block = 0; block < prm.header.blocks; ++block) {
    const uint32_t rank = prm.block_rank[block], first = prm.block_first_link[block], links = prm.block_first_link[block + 1] - first;
    const uint32_t* link = prm.link_wavelet.data() + first;
    if (rank <= 2) sumLinks<1>(link, links, coefficient, wavelet_rgb, rank, to);
    else if (rank <= 5) sumLinks<2>(link, links, coefficient, wavelet_rgb, rank, to);
    else if (rank <= 8) sumLinks<3>(link, links, coefficient, wavelet_rgb, rank, to);
    else sumLinksOfAnyRank(link, links, coefficient, wavelet_rgb, rank, to);
    coefficient += size_t(links) * rank * 3;
    for (uint32_t i = 0; i < rank * 3; ++i) *to++ *= *scale++;
  }
}

#ifdef LIGHTWELL_AVX2
[[gnu::target("avx2,fma")]] void sumBlocksAvx2(const lw_prm& prm, const float* wavelet_rgb, float* to) { sumBlocks(prm, wavelet_rgb, to); }
#endif
void sumBlocksPlain(const lw_prm& prm, const float* wavelet_rgb, float* to) { sumBlocks(prm, wavelet_rgb, to); }

}  // namespace

size_t amountScratchFloats(const lw_prm& prm) { return prm.tree.wavelets() * 3 + prm.coefficient_scale.size(); }

const float* amounts(const lw_prm& prm, const float* cluster_rgb, float* scratch) {
  float *wavelet_rgb = scratch, *amount_rgb = scratch + prm.tree.wavelets() * 3;
  prm.tree.transform(cluster_rgb, wavelet_rgb);
#ifdef LIGHTWELL_AVX2
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    sumBlocksAvx2(prm, wavelet_rgb, amount_rgb);
    return amount_rgb;
  }
#endif
  sumBlocksPlain(prm, wavelet_rgb, amount_rgb);
  return amount_rgb;
}

}  // namespace lightwell::runtime
