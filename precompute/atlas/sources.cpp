#include "precompute/atlas/sources.h"

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <queue>
#include <tuple>

namespace lightwell::atlas {
namespace {

constexpr int64_t kAnyDistance = std::numeric_limits<int64_t>::max();

/// Spreads seeds from texel to texel in order of distance: every texel takes the nearest seed that its neighbours know (dead
/// reckoning on the eight-neighbourhood). Ties go to the lower seed, then the lower texel, so that the result is one and the same.
class Spread {
 public:
  Spread(int width, int height) : width_(width), height_(height), seed_(size_t(width) * height, kNone) {}

  void addSeed(uint32_t texel) { seed_[texel] = texel; }

  /// The seed of every texel; kNone where none arrived. `admit(texel, seed)`: may this texel, no seed itself, take that seed?
  template <class Admit>
  std::vector<uint32_t> run(int64_t most_distance2, Admit admit) {
    const uint32_t texels = uint32_t(seed_.size());
    for (uint32_t texel = 0; texel < texels; ++texel)
      if (seed_[texel] == texel) offerToNeighbours(texel, most_distance2, admit);
    while (!queue_.empty()) {
      const auto [distance2, seed, texel] = queue_.top();
      queue_.pop();
      if (seed_[texel] == seed) offerToNeighbours(texel, most_distance2, admit);
    }
    return std::move(seed_);
  }

 private:
  using Entry = std::tuple<int64_t, uint32_t, uint32_t>;  // squared distance, seed, texel

  int64_t distance2(uint32_t a, uint32_t b) const {
    const int64_t w = width_, dx = a % w - b % w, dy = a / w - b / w;
    return dx * dx + dy * dy;
  }
  template <class Admit>
  void offerToNeighbours(uint32_t texel, int64_t most_distance2, Admit& admit) {
    const uint32_t seed = seed_[texel];
    const int x = int(texel % uint32_t(width_)), y = int(texel / uint32_t(width_));
    for (int ny = std::max(0, y - 1); ny <= std::min(height_ - 1, y + 1); ++ny)
      for (int nx = std::max(0, x - 1); nx <= std::min(width_ - 1, x + 1); ++nx) {
        const uint32_t next = uint32_t(ny) * uint32_t(width_) + uint32_t(nx);
        if (seed_[next] == next || seed_[next] == seed || !admit(next, seed)) continue;
        const int64_t d = distance2(next, seed);
        if (d > most_distance2) continue;
        if (seed_[next] != kNone && std::pair(distance2(next, seed_[next]), seed_[next]) <= std::pair(d, seed)) continue;
        seed_[next] = seed;
        queue_.push({d, seed, next});
      }
  }

  int width_, height_;
  std::vector<uint32_t> seed_;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue_;
};

/// The valid texel of `chart` that is next in the order of rows, for a texel that lies apart from the rest of its chart; kNone without any.
/// `valid_texels` holds (chart, texel) in ascending order.
uint32_t nextInChart(const std::vector<std::pair<uint32_t, uint32_t>>& valid_texels, uint32_t chart, uint32_t texel) {
  const auto after = std::lower_bound(valid_texels.begin(), valid_texels.end(), std::pair(chart, texel));
  const bool has_after = after != valid_texels.end() && after->first == chart;
  const bool has_before = after != valid_texels.begin() && (after - 1)->first == chart;
  if (has_before && (!has_after || texel - (after - 1)->second <= after->second - texel)) return (after - 1)->second;
  return has_after ? after->second : kNone;
}

}  // namespace

uint32_t fillSources(Atlas& atlas, const std::vector<uint8_t>& valid) {
  const auto chartOf = [&](uint32_t texel) { return atlas.slots[atlas.texel_slot[texel]].chart; };
  Spread within_charts(atlas.width, atlas.height);
  std::vector<std::pair<uint32_t, uint32_t>> valid_texels;
  for (size_t i = 0; i < atlas.slots.size(); ++i)
    if (valid[i]) {
      within_charts.addSeed(atlas.slots[i].texel);
      valid_texels.push_back({atlas.slots[i].chart, atlas.slots[i].texel});
    }
  std::sort(valid_texels.begin(), valid_texels.end());
  atlas.source = within_charts.run(kAnyDistance, [&](uint32_t texel, uint32_t seed) {
    return atlas.texel_slot[texel] != kNone && chartOf(texel) == chartOf(seed);
  });
  uint32_t unfilled = 0;
  for (const Slot& slot : atlas.slots) {
    uint32_t& source = atlas.source[slot.texel];
    if (source == kNone) source = nextInChart(valid_texels, slot.chart, slot.texel);
    if (source == kNone) {
      source = slot.texel;
      ++unfilled;
    }
  }

  Spread over_gutters(atlas.width, atlas.height);
  for (const Slot& slot : atlas.slots) over_gutters.addSeed(slot.texel);
  const std::vector<uint32_t> nearest = over_gutters.run(int64_t(kGutterTexels) * kGutterTexels, [&](uint32_t texel, uint32_t) {
    return atlas.texel_slot[texel] == kNone;
  });
  for (size_t texel = 0; texel < nearest.size(); ++texel)
    if (atlas.texel_slot[texel] == kNone && nearest[texel] != kNone) atlas.source[texel] = atlas.source[nearest[texel]];
  return unfilled;
}

}  // namespace lightwell::atlas
