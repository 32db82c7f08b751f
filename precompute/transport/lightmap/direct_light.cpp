#include "precompute/transport/lightmap/direct_light.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lightwell::transport {
namespace {

constexpr uint64_t kSoftStream = 10ull << 40;
constexpr uint32_t kBatchPaths = 4096;
constexpr float kUneven = 1;            // difference to a neighbour, over the mean of the scene
constexpr float kMostContrast = 0.25f;  // between a texel and its neighbours, for few samples to be believed

/// Of emitters and the sky.
struct SoftSums {
  uint32_t side;
  std::array<Vec3d, kSampleGroups> sum{};
  Vec3d gradient{0, 0, 0};  // weighted by luminance, of all groups
  uint32_t count = 0;       // of each group
};

/// Gives each of `list` `count` samples in each group.
void sampleSoftLight(const PathContext& context, const Sides& sides, const DirectOptions& options, uint32_t count, std::span<SoftSums*> list) {
  PathBatch batch(context);
  std::vector<PathStart> starts;
  std::vector<std::pair<SoftSums*, uint32_t>> owner;  // and group
  std::vector<Rgb> irradiance_rgb;
  const PathBatch::Arrival arrival = [&](uint32_t start, const Vec3& direction, const Rgb& arrived_rgb) {
    SoftSums& sums = *owner[start].first;
    const Vec3& normal = context.atlas.slots[sides.slot[sums.side]].normal;
    sums.gradient += Vec3d(options.tilt->gradient(sides.isBack(sums.side) ? -normal : normal, direction)) * double(luminance(arrived_rgb));
  };
  const auto flush = [&] {
    batch.trace(starts, irradiance_rgb, options.tilt ? &arrival : nullptr);
    for (size_t i = 0; i < starts.size(); ++i) owner[i].first->sum[owner[i].second] += Vec3d(irradiance_rgb[i]);
    starts.clear(), owner.clear();
  };
  for (SoftSums* sums : list) {
    const uint32_t slot = sides.slot[sums->side];
    for (uint32_t i = 0; i < count; ++i)
      for (uint32_t group = 0; group < kSampleGroups; ++group) {
        const uint64_t owner_key = combineKeys(uint64_t(sums->side) + kSoftStream, group);
        starts.push_back({slot, i, Sampler(options.seed, owner_key), combineKeys(combineKeys(options.seed, owner_key), i), sides.isBack(sums->side)});
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

/// Luminance of the slots beside `slot` in its chart, itself among them.
template <class Body>
void forBeside(const atlas::Atlas& atlas, std::span<const Rgb> irradiance_rgb, uint32_t slot, const Body& body) {
  const int x = int(atlas.slots[slot].texel) % atlas.width, y = int(atlas.slots[slot].texel) / atlas.width;
  for (int ty = std::max(0, y - 1); ty <= std::min(atlas.height - 1, y + 1); ++ty)
    for (int tx = std::max(0, x - 1); tx <= std::min(atlas.width - 1, x + 1); ++tx) {
      const uint32_t other = atlas.texel_slot[size_t(ty) * size_t(atlas.width) + size_t(tx)];
      if (other == kNone || atlas.slots[other].chart != atlas.slots[slot].chart) continue;
      body(luminance(irradiance_rgb[other]));
    }
}

/// The greatest difference between a slot and those beside it in its chart, over the greater of the two and `dark`.
float contrast(const atlas::Atlas& atlas, std::span<const Rgb> irradiance_rgb, uint32_t slot, float dark) {
  const float own = luminance(irradiance_rgb[slot]);
  float most = 0;
  forBeside(atlas, irradiance_rgb, slot, [&](float there) { most = std::max(most, std::abs(there - own) / std::max({there, own, dark, 1e-30f})); });
  return most;
}

/// Sums of the sides [first, end), and pointers to all of them.
template <class Sums>
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

std::vector<Rgb> firstDirectLight(const DirectSampler::Context& context, const DirectOptions& options, uint32_t first, uint32_t end) {
  SideSums<DirectSums> sums(first, end);
  DirectSampler(context).sample(options.samples / kSampleGroups, sums.list);
  std::vector<Rgb> irradiance_rgb;
  for (const DirectSums& s : sums.all) irradiance_rgb.push_back(Rgb(s.mean()));
  return irradiance_rgb;
}

GatheredPair directLight(const DirectSampler::Context& context, const DirectOptions& options, std::span<const Rgb> first_light_rgb, uint32_t first, uint32_t end) {
  const float dark = 0.1f * meanIrradiance(context.atlas, first_light_rgb);
  SideSums<DirectSums> sums(first, end);
  DirectSampler sampler(context);
  std::vector<DirectSums*> open = sums.list;
  for (uint32_t count = options.samples / kSampleGroups; !open.empty(); count *= 4) {
    sampler.sample(count, open);
    if (4 * count * kSampleGroups > options.most_samples) break;
    std::erase_if(open, [&](const DirectSums* s) {
      if (context.sides.isBack(s->side)) return true;
      if (count * kSampleGroups < options.edge_samples && contrast(context.atlas, first_light_rgb, s->side, dark) > kMostContrast) return false;
      return s->standardError() <= options.error * (luminance(Rgb(s->mean())) + dark);
    });
  }
  GatheredPair pair;
  for (const DirectSums& s : sums.all) {
    pair.a_rgb.push_back(Rgb(s.mean(0, kSampleGroups / 2)));
    pair.b_rgb.push_back(Rgb(s.mean(kSampleGroups / 2, kSampleGroups)));
    if (context.tilt) pair.gradient.push_back(s.gradient());
  }
  return pair;
}

GatheredPair softLight(const PathContext& context, const Sides& sides, const DirectOptions& options, uint32_t first, uint32_t end) {
  SideSums<SoftSums> sums(first, end);
  const uint32_t count = std::max(1u, options.soft_samples / kSampleGroups), back_count = std::max(1u, count / 8);
  const auto backs = std::partition(sums.list.begin(), sums.list.end(), [&](const SoftSums* s) { return !sides.isBack(s->side); });
  sampleSoftLight(context, sides, options, count, std::span(sums.list.begin(), backs));
  sampleSoftLight(context, sides, options, back_count, std::span(backs, sums.list.end()));
  GatheredPair pair;
  for (const SoftSums& s : sums.all) {
    pair.a_rgb.push_back(Rgb((s.sum[0] + s.sum[1]) / double(2 * s.count)));
    pair.b_rgb.push_back(Rgb((s.sum[2] + s.sum[3]) / double(2 * s.count)));
    if (options.tilt) pair.gradient.push_back(Vec3(s.gradient / double(kSampleGroups * s.count)));
  }
  return pair;
}

std::vector<uint8_t> unevenSlots(const scene::Mesh& mesh, const atlas::Atlas& atlas, const PunctualLights& lamps, std::span<const Rgb> irradiance_rgb) {
  const float most = kUneven * meanIrradiance(atlas, irradiance_rgb);
  std::vector<uint8_t> uneven(atlas.slots.size());
  for (uint32_t slot = 0; slot < uneven.size(); ++slot) {
    const float own = luminance(irradiance_rgb[slot]);
    forBeside(atlas, irradiance_rgb, slot, [&](float there) {
      if (std::abs(there - own) > most) uneven[slot] = uint8_t(LookUp::at_point);
    });
    if (nearLamp(mesh, atlas, lamps, atlas.slots[slot], false).spot) uneven[slot] = uint8_t(LookUp::of_texel);
  }
  return uneven;
}

}  // namespace lightwell::transport
