// The sum over links, for whichever instructions the including file is compiled for.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>

#include "runtime/src/prm_links.h"

namespace lightwell::runtime {
namespace {

inline float squared(float r, float g, float b, float scale) {
  r *= scale, g *= scale, b *= scale;
  return r * r + g * g + b * b;
}

/// The least power of a change that is read: what is below adds up to `most` or less. `pieces`: of all wavelets.
inline float leastPower(const float* power, const float* cost, size_t count, size_t pieces, float most) {
  constexpr int kSteps = 8;  // of 20 octaves, where there are a million pieces
  // No change may be left out whose power alone is more; and all may that share it evenly. Floats that are not negative are in the order of their bits.
  uint32_t low = std::bit_cast<uint32_t>(most / float(pieces)), high = std::bit_cast<uint32_t>(most);
  for (int step = 0; step < kSteps && low < high; ++step) {
    const uint32_t middle = low + (high - low + 1) / 2;
    const float least = std::bit_cast<float>(middle);
    float left_out = 0;
#pragma omp simd reduction(+ : left_out)
    for (size_t i = 0; i < count; ++i) left_out += power[i] < least ? cost[i] : 0.0f;
    if (left_out <= most) low = middle;
    else high = middle - 1;
  }
  return std::bit_cast<float>(low);
}

/// Lists the wavelets whose change is to be read and returns their number.
inline size_t chooseChanges(const LinkArrays& links, const LinkChange& change, float tolerance) {
  const size_t wavelets = links.wavelets;
  const float *__restrict to = change.wavelet_rgb, *__restrict from = change.applied_rgb, *__restrict per_piece = links.power;
  const uint32_t* __restrict first_piece = links.first_piece;
  float *__restrict power = change.power, *__restrict cost = change.cost;
  uint32_t* __restrict chosen = change.chosen;
  float largest = 0;
#pragma omp simd reduction(max : largest)
  for (size_t i = 0; i < wavelets * 3; ++i) {
    const float a = std::fabs(to[i]), b = std::fabs(from[i]), more = a > b ? a : b;
    largest = largest > more ? largest : more;
  }
  const float scale = 1.0f / largest;  // squares of very bright and very dim light stay in range
  const bool leave_out = tolerance > 0 && std::isfinite(scale) && scale > 0;
  float all = 0;
  if (leave_out) {
#pragma omp simd reduction(+ : all)
    for (size_t w = 0; w < wavelets; ++w) {
      const float r = to[w * 3], g = to[w * 3 + 1], b = to[w * 3 + 2];
      const float pieces = float(int32_t(first_piece[w + 1] - first_piece[w]));
      all += squared(r, g, b, scale) * per_piece[w] * pieces;
      power[w] = squared(r - from[w * 3], g - from[w * 3 + 1], b - from[w * 3 + 2], scale) * per_piece[w];
      cost[w] = power[w] * pieces;
    }
  } else {
    for (size_t w = 0; w < wavelets; ++w) power[w] = to[w * 3] != from[w * 3] || to[w * 3 + 1] != from[w * 3 + 1] || to[w * 3 + 2] != from[w * 3 + 2] ? 1.0f : 0.0f;
  }
  // Most wavelets of most lights do not change.
  size_t changed = 0;
  for (size_t w = 0; w < wavelets; ++w) {
    chosen[changed] = uint32_t(w);
    changed += power[w] > 0;
  }
  if (!leave_out) return changed;
  for (size_t i = 0; i < changed; ++i) {
    const uint32_t w = chosen[i];
    power[i] = power[w];
    cost[i] = cost[w];
  }
  const float least = leastPower(power, cost, changed, first_piece[wavelets], tolerance * tolerance * all);
  size_t kept = 0;
  for (size_t i = 0; i < changed; ++i) {
    chosen[kept] = chosen[i];
    kept += power[i] >= least;
  }
  return kept;
}

/// Eight::add(sum, coefficient, light): sum[i] += coefficient[i] light[i] for i < 8.
template <class Eight>
size_t addChanges(const LinkArrays links, const LinkChange change, float tolerance) {
  constexpr size_t kAhead = 4, kLine = 64, kMostLines = 4;  // wavelets lie anywhere: memory is asked for them while others are summed
  const size_t chosen = chooseChanges(links, change, tolerance);
  float* const sums = change.sums;
  uint8_t* const touched = change.touched;
  size_t read = 0;
  for (size_t i = 0; i < chosen; ++i) {
    if (i + kAhead < chosen) {
      const size_t next = change.chosen[i + kAhead], first = links.first_piece[next], lines = (links.first_piece[next + 1] - first) * 8 / kLine + 1;
      __builtin_prefetch(links.place + first);
      for (size_t line = 0; line < std::min(kMostLines, lines); ++line) __builtin_prefetch(links.coefficient + first * 8 + line * kLine);
    }
    const size_t w = change.chosen[i];
    const float* to = change.wavelet_rgb + w * 3;
    float* from = change.applied_rgb + w * 3;
    const float r = to[0] - from[0], g = to[1] - from[1], b = to[2] - from[2];
    for (int k = 0; k < 3; ++k) from[k] = to[k];
    const float light[3][8] = {{r, g, b, r, g, b, r, g}, {g, b, r, g, b, r, g, b}, {b, r, g, b, r, g, b, r}};
    const size_t end = links.first_piece[w + 1];
    read += end - links.first_piece[w];
    for (size_t p = links.first_piece[w]; p < end; ++p) {
      const uint32_t place = links.place[p], at = place & ((1u << kChannelShift) - 1);
      Eight::add(sums + size_t(at) * 8, links.coefficient + p * 8, light[place >> kChannelShift]);
      touched[at] = 1;
    }
  }
  return read;
}

}  // namespace
}  // namespace lightwell::runtime
