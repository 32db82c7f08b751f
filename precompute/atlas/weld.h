// Numbers that equal things share.
#pragma once
#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace lightwell::atlas {

/// Per index in [0, count) the lowest index with an equal key(index); keys need < and ==.
template <class Key>
std::vector<uint32_t> weld(size_t count, Key key) {
  std::vector<uint32_t> order(count), welded(count);
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return key(a) == key(b) ? a < b : key(a) < key(b); });
  for (size_t i = 0; i < count; ++i) welded[order[i]] = i > 0 && key(order[i]) == key(order[i - 1]) ? welded[order[i - 1]] : order[i];
  return welded;
}

}  // namespace lightwell::atlas
