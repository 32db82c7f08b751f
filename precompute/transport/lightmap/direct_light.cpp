#include "precompute/transport/lightmap/direct_light.h"

#include <array>
#include <cmath>

namespace lightwell::transport {
namespace {

constexpr uint32_t kGroups = 4;          // independently scrambled: their scatter tells the error
constexpr uint32_t kBatchPaths = 4096;

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

}  // namespace

std::vector<Rgb> firstDirectLight(const PathContext& context, const Sides& sides, const DirectOptions& options, uint32_t first, uint32_t end) {
  DirectOptions once = options;
  once.most_samples = options.samples;
  return directLight(context, sides, once, 0, first, end);
}

std::vector<Rgb> directLight(const PathContext& context, const Sides& sides, const DirectOptions& options, float mean_irradiance, uint32_t first, uint32_t end) {
  std::vector<Sums> all(end - first);
  std::vector<Sums*> open;
  for (uint32_t side = first; side < end; ++side) {
    all[side - first].side = side;
    open.push_back(&all[side - first]);
  }
  for (uint32_t count = options.samples / kGroups; !open.empty(); count *= 4) {
    sample(context, sides, options.seed, count, open);
    if (4 * count * kGroups > options.most_samples) break;
    std::erase_if(open, [&](const Sums* sums) {
      return sides.isBack(sums->side) || sums->standardError() <= options.error * (luminance(Rgb(sums->mean())) + 0.1f * mean_irradiance);
    });
  }
  std::vector<Rgb> irradiance_rgb;
  for (const Sums& sums : all) irradiance_rgb.push_back(Rgb(sums.mean()));
  return irradiance_rgb;
}

GatheredPair softLight(const PathContext& context, const Sides& sides, const DirectOptions& options, uint32_t first, uint32_t end) {
  std::vector<Sums> all(end - first);
  std::vector<Sums*> list;
  for (uint32_t side = first; side < end; ++side) {
    all[side - first].side = side;
    list.push_back(&all[side - first]);
  }
  const uint32_t count = std::max(1u, options.soft_samples / kGroups);
  sample(context, sides, options.seed, count, list);
  GatheredPair pair;
  for (const Sums& sums : all) {
    pair.a_rgb.push_back(Rgb((sums.sum[0] + sums.sum[1]) / double(2 * count)));
    pair.b_rgb.push_back(Rgb((sums.sum[2] + sums.sum[3]) / double(2 * count)));
  }
  return pair;
}

}  // namespace lightwell::transport
