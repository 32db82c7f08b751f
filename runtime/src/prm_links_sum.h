// The sum over links, for whichever instructions the including file is compiled for.
#pragma once
#include "runtime/src/prm_links.h"

namespace lightwell::runtime {
namespace {

inline float squared(float r, float g, float b, float scale) {
  r *= scale, g *= scale, b *= scale;
  return r * r + g * g + b * b;
}

/// `vectors`: of eight numbers, in a block's sums; 0: not known here. Eight::add(sum, coefficient, light): sum[i] += coefficient[i] light[i] for i < 8.
template <class Eight, size_t vectors>
size_t addChanges(const LinkArrays links, const LinkChange change) {
  const size_t stride = links.stride;
  const size_t count = vectors ? vectors : stride / 8;
  float* const sums = change.sums;
  uint8_t* const touched = change.touched;
  size_t read = 0;
  for (size_t w = 0; w < links.wavelets; ++w) {
    const float* to = change.wavelet_rgb + w * 3;
    float* from = change.applied_rgb + w * 3;
    const float r = to[0] - from[0], g = to[1] - from[1], b = to[2] - from[2];
    if ((r == 0 && g == 0 && b == 0) || squared(r, g, b, change.scale) * links.power[w] < change.least) continue;
    for (int k = 0; k < 3; ++k) from[k] = to[k];
    // The channel of a number repeats after three vectors.
    const float light[24] = {r, g, b, r, g, b, r, g, b, r, g, b, r, g, b, r, g, b, r, g, b, r, g, b};
    const int8_t* coefficient = links.coefficient + links.first_coefficient[w];
    const uint32_t end = links.first_link[w + 1];
    read += end - links.first_link[w];
    for (uint32_t l = links.first_link[w]; l < end; ++l) {
      const size_t block = links.link_block[l];
      float* sum = sums + block * stride;
      for (size_t v = 0; v < count; ++v) Eight::add(sum + v * 8, coefficient + v * 8, light + v % 3 * 8);
      touched[block] = 1;
      coefficient += links.numbers[block];
    }
  }
  return read;
}

template <class Eight>
size_t addChanges(const LinkArrays& links, const LinkChange& change) {
  switch (links.stride / 8) {
    case 1: return addChanges<Eight, 1>(links, change);
    case 2: return addChanges<Eight, 2>(links, change);
    case 3: return addChanges<Eight, 3>(links, change);
    default: return addChanges<Eight, 0>(links, change);
  }
}

}  // namespace
}  // namespace lightwell::runtime
