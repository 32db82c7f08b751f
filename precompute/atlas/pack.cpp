#include "precompute/atlas/pack.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace {

/// The library sorts with qsort, whose order of equal rectangles depends on the C library; this one is stable everywhere.
void stableSort(void* base, size_t count, size_t size, int (*compare)(const void*, const void*));

}  // namespace

#define STBRP_STATIC
#define STBRP_SORT stableSort
#define STB_RECT_PACK_IMPLEMENTATION
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#endif
#include <stb_rect_pack.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace {

void stableSort(void* base, size_t count, size_t, int (*compare)(const void*, const void*)) {
  auto* rects = static_cast<stbrp_rect*>(base);
  std::stable_sort(rects, rects + count, [compare](const stbrp_rect& a, const stbrp_rect& b) { return compare(&a, &b) < 0; });
}

}  // namespace

namespace lightwell::atlas {
namespace {

constexpr double kCollapseTexels = 0.75;  // charts smaller than this in both directions are one texel
constexpr int kBlockSide = 8;             // collapsed charts go side by side in square blocks of at most this side
constexpr int kHalvings = 60;             // of the density, until everything is collapsed

/// Packs `rects` bin by bin; true when all found a place.
bool packRects(std::vector<stbrp_rect>& rects, std::span<const TexelRect> bins) {
  std::vector<stbrp_rect> waiting = rects;
  std::vector<stbrp_node> nodes;
  for (const TexelRect& bin : bins) {
    if (waiting.empty()) break;
    nodes.resize(size_t(bin.width));
    stbrp_context context;
    stbrp_init_target(&context, bin.width, bin.height, nodes.data(), int(nodes.size()));
    stbrp_setup_heuristic(&context, STBRP_HEURISTIC_Skyline_BF_sortHeight);
    stbrp_pack_rects(&context, waiting.data(), int(waiting.size()));
    std::vector<stbrp_rect> rest;
    for (const stbrp_rect& rect : waiting) {
      if (rect.was_packed) {
        rects[size_t(rect.id)].x = rect.x + bin.x;
        rects[size_t(rect.id)].y = rect.y + bin.y;
      } else {
        rest.push_back(rect);
      }
    }
    waiting = std::move(rest);
  }
  return waiting.empty();
}

std::optional<Packing> packAt(std::span<const Vec2d> extents, std::span<const TexelRect> bins, int padding, double texels_per_unit) {
  Packing packing{std::vector<Placement>(extents.size()), texels_per_unit};
  std::vector<stbrp_rect> rects;
  std::vector<size_t> whole, collapsed;  // charts
  double texels_needed = 0, texels_free = 0;
  for (const TexelRect& bin : bins) texels_free += double(bin.width) * bin.height;
  for (size_t i = 0; i < extents.size(); ++i) {
    const Vec2d texels = extents[i] * texels_per_unit;
    if (std::max(texels.x, texels.y) < kCollapseTexels) {
      collapsed.push_back(i);
      continue;
    }
    const double width = std::max(1.0, std::round(texels.x)), height = std::max(1.0, std::round(texels.y));
    texels_needed += (width + padding) * (height + padding);
    if (texels_needed > texels_free) return std::nullopt;
    rects.push_back({int(rects.size()), int(width) + padding, int(height) + padding, 0, 0, 0});
    whole.push_back(i);
  }
  const int side = std::clamp(int(std::ceil(std::sqrt(double(collapsed.size())))), 1, kBlockSide);
  const size_t block = size_t(side) * side;
  for (size_t first = 0; first < collapsed.size(); first += block) {
    const int count = int(std::min(block, collapsed.size() - first));
    rects.push_back({int(rects.size()), std::min(count, side) + padding, (count + side - 1) / side + padding, 0, 0, 0});
  }
  if (!packRects(rects, bins)) return std::nullopt;

  for (size_t i = 0; i < whole.size(); ++i)
    packing.placements[whole[i]] = {{rects[i].x, rects[i].y, rects[i].w - padding, rects[i].h - padding}, false};
  for (size_t i = 0; i < collapsed.size(); ++i) {
    const stbrp_rect& rect = rects[whole.size() + i / block];
    const int place = int(i % block);
    packing.placements[collapsed[i]] = {{rect.x + place % side, rect.y + place / side, 1, 1}, true};
  }
  return packing;
}

/// A rectangle of the largest area in which every cell of `free` is set; by a stack of rising columns, row by row.
TexelRect largestFreeRectangle(const std::vector<uint8_t>& free, int width, int height) {
  TexelRect best;
  std::vector<int> column(size_t(width) + 1, 0), stack;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) column[x] = free[size_t(y) * width + x] ? column[x] + 1 : 0;
    stack.clear();
    for (int x = 0; x <= width; ++x) {
      while (!stack.empty() && column[stack.back()] >= column[x]) {
        const int tall = column[stack.back()];
        stack.pop_back();
        const int left = stack.empty() ? 0 : stack.back() + 1;
        if (tall * (x - left) > best.width * best.height) best = {left, y - tall + 1, x - left, tall};
      }
      stack.push_back(x);
    }
  }
  return best;
}

}  // namespace

std::optional<Packing> packCharts(std::span<const Vec2d> extents, std::span<const TexelRect> bins, int padding,
                                  double most_texels_per_unit) {
  double area = 0, texels = 0, longest = 0;
  for (const Vec2d& extent : extents) {
    area += extent.x * extent.y;
    longest = std::max(longest, extent.x);
  }
  for (const TexelRect& bin : bins) texels += double(bin.width) * bin.height;
  double high = most_texels_per_unit;
  if (area > 0) high = std::min(high, std::sqrt(texels / area));
  if (longest > 0) high = std::min(high, 2 * std::sqrt(2.0) * 8192 / longest);
  if (auto packing = packAt(extents, bins, padding, high)) return packing;
  // The density falls until everything fits, then rises again between the last two steps.
  std::optional<Packing> best;
  double low = high;
  for (int i = 0; i < kHalvings && !best; ++i) {
    high = low;
    low = i + 1 == kHalvings ? 0 : low / std::sqrt(2.0);
    best = packAt(extents, bins, padding, low);
  }
  for (int i = 0; best && low > 0 && i < 6; ++i) {
    const double middle = std::sqrt(low * high);
    if (auto packing = packAt(extents, bins, padding, middle)) {
      best = std::move(packing);
      low = middle;
    } else {
      high = middle;
    }
  }
  return best;
}

int smallestAtlas(size_t charts, int padding, int limit) {
  const std::vector<Vec2d> extents(charts, Vec2d(0, 0));
  const auto fits = [&](int size) {
    const TexelRect bin = wholeAtlas(size, padding);
    return packAt(extents, {&bin, 1}, padding, 0).has_value();
  };
  int size = std::max(1, int(std::ceil(std::sqrt(double(charts)))));
  while (size <= limit && !fits(size)) ++size;
  return std::min(size, limit + 1);
}

std::vector<TexelRect> freeRectangles(const std::vector<float>& occupied, int width, int height, int padding) {
  // Cells of several texels keep the search for rectangles cheap on large atlases.
  constexpr int kMostCells = 1024, kMostRectangles = 48;
  const int cell = (std::max(width, height) + kMostCells - 1) / kMostCells;
  const int columns = width / cell, rows = height / cell;
  std::vector<uint8_t> free(size_t(columns) * rows, 1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      if (!(occupied[size_t(y) * width + x] > 0)) continue;
      const int last_row = std::min(rows - 1, (y + padding) / cell), last_column = std::min(columns - 1, (x + padding) / cell);
      for (int row = std::min(rows - 1, y / cell); row <= last_row; ++row)
        for (int column = std::min(columns - 1, x / cell); column <= last_column; ++column) free[size_t(row) * columns + column] = 0;
    }
  std::vector<TexelRect> rectangles;
  while (rectangles.size() < kMostRectangles) {
    const TexelRect found = largestFreeRectangle(free, columns, rows);
    if (found.width == 0) break;
    for (int y = found.y; y < found.y + found.height; ++y)
      std::fill_n(free.begin() + ptrdiff_t(y) * columns + found.x, found.width, uint8_t(0));
    rectangles.push_back({found.x * cell, found.y * cell, found.width * cell, found.height * cell});
  }
  return rectangles;
}

}  // namespace lightwell::atlas
