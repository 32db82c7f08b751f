// Texels of a block, a tile at a time, for whichever instructions the including file is compiled for.
#pragma once
#include <algorithm>
#include <bit>
#include <cfloat>
#include <cstdint>
#include <cstring>

namespace lightwell::runtime {

typedef float Float4 __attribute__((vector_size(16)));

/// See reconstructTile() and packTile() below. Return whether the machine could.
bool reconstructTileAvx2(const Float4* amount_rgb, uint32_t rank, const int8_t* basis, uint32_t count, float* values_rgba);
bool packTileAvx2(const float* values_rgba, uint32_t count, uint16_t* halfs_rgba);

namespace {

/// Texels as [count][4], alpha 1: the sums over the ranks of `amount_rgb`, of a step of the basis each, times `basis`, [count][rank]; finite, not negative.
inline void reconstructTile(const Float4* amount_rgb, uint32_t rank, const int8_t* basis, uint32_t count, float* values_rgba) {
  constexpr uint32_t kNumbers = 2048;
  float number[kNumbers];
  const uint32_t most = kNumbers / std::max(rank, 1u);
  for (uint32_t first = 0; first < count; first += most) {
    const uint32_t texels = std::min(most, count - first);
    for (uint32_t i = 0; i < texels * rank; ++i) {
      const int v = basis[i];
      number[i] = float(v < -127 ? -127 : v);
    }
    basis += texels * rank;
    for (uint32_t t = 0; t < texels; ++t, values_rgba += 4) {
      Float4 sum{};
      for (uint32_t k = 0; k < rank; ++k) sum += amount_rgb[k] * number[t * rank + k];
      constexpr Float4 kNothing{}, kMost{FLT_MAX, FLT_MAX, FLT_MAX, FLT_MAX};
      sum = sum > kNothing ? sum : kNothing;  // of what is no number, too
      sum = sum < kMost ? sum : kMost;
      sum[3] = 1.0f;
      std::memcpy(values_rgba, &sum, sizeof sum);
    }
  }
}

/// format::packHalf without branches, so that loops become vectors: to the nearest half, ties to even. The values are not negative; above 65504 they become that.
inline void packTile(const float* values_rgba, uint32_t count, uint16_t* halfs_rgba) {
  constexpr uint32_t kLeastNormal = 113u << 23, kHalf = 126u << 23;
  for (uint32_t i = 0; i < count * 4; ++i) {
    const float v = values_rgba[i] < 65504.0f ? values_rgba[i] : 65504.0f;
    const uint32_t bits = std::bit_cast<uint32_t>(v);
    const uint32_t normal = (bits - (112u << 23) + 0xfffu + (bits >> 13 & 1u)) >> 13;
    const uint32_t subnormal = std::bit_cast<uint32_t>(v + 0.5f) - kHalf;  // a half's subnormals are the steps of floats from 0.5 to 1
    halfs_rgba[i] = uint16_t(bits < kLeastNormal ? subnormal : normal);
  }
}

}  // namespace
}  // namespace lightwell::runtime
