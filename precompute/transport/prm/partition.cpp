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
    float spacing = 1;
    for (uint32_t i = begin; i < end; ++i) spacing = std::min(spacing, elements[partition.order[i]].spacing);
    const auto length = [&](int axis) { return (high[axis] - low[axis]) / (axis < 3 ? spacing : 1.0f); };
    int longest = 0;
    for (int axis = 1; axis < 6; ++axis)
      if (length(axis) > length(longest)) longest = axis;
    const bool too_wide = length(longest) > 1.0f;
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

std::array<std::vector<uint32_t>, 2> bisect(std::span<const SurfaceElement> elements) {
  Box3 bounds;
  for (const auto& element : elements) bounds.extendBy(element.position);
  const float extent = std::max(1e-6f, maxComponent(bounds.size()));
  int longest = 0;
  float length = -1, at = 0;
  for (int axis = 0; axis < 6; ++axis) {
    const auto value = [&](const SurfaceElement& element) { return coordinate(element, axis, extent, 0.5f); };
    const auto [low, high] = std::minmax_element(elements.begin(), elements.end(), [&](const auto& a, const auto& b) { return value(a) < value(b); });
    if (value(*high) - value(*low) > length) longest = axis, length = value(*high) - value(*low), at = 0.5f * (value(*high) + value(*low));
  }
  std::array<std::vector<uint32_t>, 2> halves;
  for (uint32_t i = 0; i < elements.size(); ++i) halves[coordinate(elements[i], longest, extent, 0.5f) < at ? 0 : 1].push_back(i);
  const size_t least = elements.size() / 4;
  if (std::min(halves[0].size(), halves[1].size()) < std::max<size_t>(1, least)) {  // nearly all on one side: as many on both
    std::vector<uint32_t> order(elements.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
      return coordinate(elements[a], longest, extent, 0.5f) < coordinate(elements[b], longest, extent, 0.5f);
    });
    const auto middle = order.begin() + std::ptrdiff_t(order.size() / 2);
    halves = {std::vector<uint32_t>(order.begin(), middle), std::vector<uint32_t>(middle, order.end())};
  }
  return halves;
}

}  // namespace lightwell::transport
