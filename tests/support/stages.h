// Stages of a bake run in ranges, as its task graph runs them.
#pragma once
#include <algorithm>
#include <vector>

#include "precompute/core/bytes.h"
#include "precompute/core/parallel.h"

namespace lightwell::test {

/// function(begin, end) for ranges of at most `grain` of [0, count), on `threads` threads: their bytes, in range order.
template <class Function>
std::vector<Bytes> inRanges(uint32_t count, uint32_t grain, int threads, Function function) {
  std::vector<Bytes> parts((count + grain - 1) / grain);
  parallelFor(parts.size(), 1, threads, nullptr, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) parts[i] = function(uint32_t(i * grain), std::min(count, uint32_t((i + 1) * grain)));
  });
  return parts;
}

inline std::vector<ByteView> views(const std::vector<Bytes>& parts) { return {parts.begin(), parts.end()}; }

}  // namespace lightwell::test
