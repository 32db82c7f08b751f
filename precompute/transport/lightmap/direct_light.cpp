#include "precompute/transport/lightmap/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lightwell::transport {
namespace {

constexpr uint32_t kGroups = 4;          // independently scrambled: their scatter tells the error
constexpr uint32_t kBatchPaths = 4096;
constexpr float kMostContrast = 0.25f;       // between a texel and its neighbours, for few samples to be believed
constexpr uint32_t kSamplesAtContrast = 256;

/// The samples of one side so far.
struct Sums {
  uint32_t side;
  std::array<Vec3d, kGroups> sum{};
  uint32_t count = 0;  // of each group

  Vec3d mean() const {
    Vec3d total(0.0);
    for (const Vec3d& s : sum) total += s;
    return total / double(kGroups * count);
  }
  double standardError() const {
    const double middle = luminance(Rgb(mean()));
    double scatter = 0;
    for (const Vec3d& s : sum) scatter += std::pow(luminance(Rgb(s / double(count))) - middle, 2.0);
    return std::sqrt(scatter / (kGroups * (kGroups - 1)));
  }
};

/// Adds samples to all of `sides`, until each group has `count`.
void sample(const PathContext& context, const Sides& sides, uint64_t seed, uint32_t count, std::span<Sums*> list) {
  PathBatch batch(context);
  std::vector<PathStart> starts;
  std::vector<std::pair<Sums*, uint32_t>> owner;  // and group
  std::vector<Rgb> irradiance_rgb;
  const auto flush = [&] {
    batch.trace(starts, irradiance_rgb);
    for (size_t i = 0; i < starts.size(); ++i) owner[i].first->sum[owner[i].second] += Vec3d(irradiance_rgb[i]);
    starts.clear(), owner.clear();
  };
  for (Sums* sums : list) {
    const uint32_t slot = sides.slot[sums->side];
    for (uint32_t i = sums->count; i < count; ++i)
      for (uint32_t group = 0; group < kGroups; ++group) {
        const uint64_t owner_key = combineKeys(uint64_t(sums->side) + (5ull << 40), group);
        starts.push_back({slot, i, Sampler(seed, owner_key), combineKeys(combineKeys(seed, owner_key), i), sides.isBack(sums->side)});
        owner.emplace_back(sums, group);
      }
    sums->count = count;
    if (starts.size() >= kBatchPaths) flush();
  }
  flush();
}

/// Luminance over the fronts, by area.
float meanIrradiance(const atlas::Atlas& atlas, std::span<const Rgb> irradiance_rgb) {
  double sum = 0, area = 0;
  for (size_t slot = 0; slot < atlas.slots.size(); ++slot) {
    sum += luminance(irradiance_rgb[slot]) * double(atlas.slots[slot].area);
    area += atlas.slots[slot].area;
  }
  return float(sum / std::max(area, 1e-30));
}

/// The greatest difference between a slot and those beside it in its chart, over the greater of the two and `dark`.
float contrast(const atlas::Atlas& atlas, std::span<const Rgb> irradiance_rgb, uint32_t slot, float dark) {
  const int x = int(atlas.slots[slot].texel) % atlas.width, y = int(atlas.slots[slot].texel) / atlas.width;
  const float own = luminance(irradiance_rgb[slot]);
  float most = 0;
  for (int ty = std::max(0, y - 1); ty <= std::min(atlas.height - 1, y + 1); ++ty)
    for (int tx = std::max(0, x - 1); tx <= std::min(atlas.width - 1, x + 1); ++tx) {
      const uint32_t other = atlas.texel_slot[size_t(ty) * size_t(atlas.width) + size_t(tx)];
      if (other == kNone || atlas.slots[other].chart != atlas.slots[slot].chart) continue;
      const float there = luminance(irradiance_rgb[other]);
      most = std::max(most, std::abs(there - own) / std::max({there, own, dark, 1e-30f}));
    }
  return most;
}

std::vector<Rgb> means(std::span<const Sums> all) {
  std::vector<Rgb> irradiance_rgb;
  for (const Sums& sums : all) irradiance_rgb.push_back(Rgb(sums.mean()));
  return irradiance_rgb;
}

/// Sums of the sides [first, end), and pointers to all of them.
struct SideSums {
  std::vector<Sums> all;
  std::vector<Sums*> list;
  SideSums(uint32_t first, uint32_t end) : all(end - first) {
    for (uint32_t side = first; side < end; ++side) {
      all[side - first].side = side;
      list.push_back(&all[side - first]);
    }
  }
};

}  // namespace

std::vector<Rgb> firstDirectLight(const PathContext& context, const Sides& sides, const DirectOptions& options, uint32_t first, uint32_t end) {
  SideSums sums(first, end);
  sample(context, sides, options.seed, options.samples / kGroups, sums.list);
  return means(sums.all);
}

std::vector<Rgb> directLight(const PathContext& context, const Sides& sides, const DirectOptions& options, std::span<const Rgb> first_light_rgb, uint32_t first,
                             uint32_t end) {
  const float dark = 0.1f * meanIrradiance(context.atlas, first_light_rgb);
  SideSums sums(first, end);
  std::vector<Sums*> open = sums.list;
  for (uint32_t count = options.samples / kGroups; !open.empty(); count *= 4) {
    sample(context, sides, options.seed, count, open);
    if (4 * count * kGroups > options.most_samples) break;
    std::erase_if(open, [&](const Sums* s) {
      if (sides.isBack(s->side)) return true;
      if (count * kGroups < kSamplesAtContrast && contrast(context.atlas, first_light_rgb, s->side, dark) > kMostContrast) return false;
      return s->standardError() <= options.error * (luminance(Rgb(s->mean())) + dark);
    });
  }
  return means(sums.all);
}

GatheredPair softLight(const PathContext& context, const Sides& sides, const DirectOptions& options, uint32_t first, uint32_t end) {
  SideSums sums(first, end);
  const uint32_t count = std::max(1u, options.soft_samples / kGroups), back_count = std::max(1u, count / 8);
  const auto backs = std::partition(sums.list.begin(), sums.list.end(), [&](const Sums* s) { return !sides.isBack(s->side); });
  sample(context, sides, options.seed, count, std::span(sums.list.begin(), backs));
  sample(context, sides, options.seed, back_count, std::span(backs, sums.list.end()));
  GatheredPair pair;
  for (const Sums& s : sums.all) {
    pair.a_rgb.push_back(Rgb((s.sum[0] + s.sum[1]) / double(2 * s.count)));
    pair.b_rgb.push_back(Rgb((s.sum[2] + s.sum[3]) / double(2 * s.count)));
  }
  return pair;
}

}  // namespace lightwell::transport
