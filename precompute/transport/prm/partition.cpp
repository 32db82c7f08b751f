#include "precompute/transport/prm/partition.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lightwell::transport {
namespace {

float coordinate(const SurfaceElement& element, int axis, float extent, float normal_extent) {
  return axis < 3 ? element.position[axis] / extent : element.normal[axis - 3] / normal_extent;
}

}  // namespace

Partition partitionByExtent(std::span<const SurfaceElement> elements, float extent, float normal_extent, size_t most_elements) {
  Partition partition;
  partition.order.resize(elements.size());
  std::iota(partition.order.begin(), partition.order.end(), 0u);
  partition.first.push_back(0);
  std::vector<std::pair<uint32_t, uint32_t>> stack;
  if (!elements.empty()) stack.emplace_back(0, uint32_t(elements.size()));
  while (!stack.empty()) {
    const auto [begin, end] = stack.back();
    stack.pop_back();
    float low[6], high[6];
    std::fill(low, low + 6, std::numeric_limits<float>::infinity());
    std::fill(high, high + 6, -std::numeric_limits<float>::infinity());
    for (uint32_t i = begin; i < end; ++i)
      for (int axis = 0; axis < 6; ++axis) {
        const float value = coordinate(elements[partition.order[i]], axis, extent, normal_extent);
        low[axis] = std::min(low[axis], value);
        high[axis] = std::max(high[axis], value);
      }
    int longest = 0;
    for (int axis = 1; axis < 6; ++axis)
      if (high[axis] - low[axis] > high[longest] - low[longest]) longest = axis;
    const bool too_wide = high[longest] - low[longest] > 1.0f;
    if ((!too_wide && end - begin <= most_elements) || end - begin == 1) {
      partition.first.push_back(end);
      continue;
    }
    const float middle = 0.5f * (low[longest] + high[longest]);
    const auto first = partition.order.begin() + begin, last = partition.order.begin() + end;
    auto split = std::stable_partition(first, last, [&](uint32_t element) {
      return coordinate(elements[element], longest, extent, normal_extent) < middle;
    });
    if (split == first || split == last) split = first + (end - begin) / 2;  // identical coordinates: only the count limit is left
    const uint32_t middle_index = uint32_t(split - partition.order.begin());
    stack.emplace_back(middle_index, end);
    stack.emplace_back(begin, middle_index);
  }
  return partition;
}

Partition partitionByCount(std::span<const SurfaceElement> elements, size_t count, float normal_extent, size_t most_elements) {
  Box3 bounds;
  for (const auto& element : elements) bounds.extendBy(element.position);
  const float largest = elements.empty() ? 1.0f : std::max(1e-6f, maxComponent(bounds.size()));
  float fine = largest * 1e-4f, coarse = largest;
  Partition best;
  for (int step = 0; step < 14; ++step) {
    const float extent = std::sqrt(fine * coarse);
    Partition candidate = partitionByExtent(elements, extent, normal_extent, most_elements);
    const auto distance = [&](const Partition& p) { return std::abs(double(p.count()) - double(count)); };
    const bool too_many = candidate.count() > count;
    if (best.first.empty() || distance(candidate) < distance(best)) best = std::move(candidate);
    (too_many ? fine : coarse) = extent;
  }
  return best;
}

}  // namespace lightwell::transport
