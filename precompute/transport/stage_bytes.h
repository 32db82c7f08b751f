// Checks on what a stage of a bake reads of another's result.
#pragma once
#include <stdexcept>
#include <vector>

namespace lightwell::transport {

inline void require(bool condition) {
  if (!condition) throw std::runtime_error("a task result is damaged");
}

/// Rows [first[i], first[i + 1]) of `entries` entries.
template <class Index>
void requireRows(const std::vector<Index>& first, size_t entries) {
  require(!first.empty() && first.front() == 0 && first.back() == entries);
  for (size_t i = 1; i < first.size(); ++i) require(first[i - 1] <= first[i]);
}

}  // namespace lightwell::transport
