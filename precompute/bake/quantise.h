// Numbers to integers times a step, without losing what they sum to.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <type_traits>

namespace lightwell::bake {

/// Quantises `count` values that lie `stride` apart to integers of at most `most` (and at least −most, or 0 when unsigned) times the
/// returned step; `integers` has the same layout. What rounding takes from one value is carried to the next (error diffusion), so that
/// every run of values keeps its sum within a step: light is neither lost nor made, however many small values there are. Zeros stay zero,
/// and with an unsigned Integer (for values ≥ 0) nothing becomes negative.
template <class Integer>
float quantiseKeepingSum(const float* values, size_t count, size_t stride, Integer* integers,
                         int most = std::numeric_limits<Integer>::max()) {
  const double least = std::is_signed_v<Integer> ? -most : 0;
  float largest = 0;
  for (size_t i = 0; i < count; ++i) largest = std::max(largest, std::abs(values[i * stride]));
  const float step = largest > 0 ? std::max(largest / float(most), std::numeric_limits<float>::min()) : 1.0f;
  double carry = 0;
  for (size_t i = 0; i < count; ++i) {
    integers[i * stride] = 0;
    if (values[i * stride] == 0) continue;
    const double wanted = double(values[i * stride]) / step + carry;
    const double rounded = std::clamp(std::round(wanted), least, double(most));
    integers[i * stride] = Integer(rounded);
    carry = wanted - rounded;
  }
  return step;
}

}  // namespace lightwell::bake
