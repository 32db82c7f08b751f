#include "precompute/transport/texel_lattice.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/core/parallel.h"

namespace lightwell::transport {
namespace {

constexpr float kSameNormal = 0.999f;   // cosine between neighbours
constexpr float kEvenDistance = 0.25f;  // by which distances to neighbours may differ, relative
constexpr float kNear = 4;              // distances to the neighbours within which nothing may stand
constexpr double kFloor = 0.1;          // of the mean
constexpr size_t kGrain = 16;

/// Directions in which something may stand on a surface: low and high over it.
constexpr int kAround = 8;
constexpr float kElevationSine[2] = {0.25f, 0.7f};

struct Step {
  int x, y;
};

class Lattice {
 public:
  Lattice(const atlas::Atlas& atlas, const trace::Tracer& tracer, const LatticeOptions& options, int threads, const CancelFlag* cancel,
          const SlotValues& evaluate)
      : atlas_(atlas), tracer_(tracer), options_(options), threads_(threads), cancel_(cancel), evaluate_(evaluate), value_rgb_(atlas.slots.size(), Rgb(0.0f)),
        known_(atlas.slots.size(), 0) {}

  std::vector<Rgb> fill(size_t& evaluated) {
    evaluated = 0;
    for (uint32_t spacing = options_.coarsest; spacing >= 1; spacing /= 2) {
      const bool first = spacing == options_.coarsest;
      std::vector<uint32_t> candidates;
      for (uint32_t slot = 0; slot < atlas_.slots.size(); ++slot) {
        const uint32_t x = atlas_.slots[slot].texel % uint32_t(atlas_.width), y = atlas_.slots[slot].texel / uint32_t(atlas_.width);
        if (!known_[slot] && x % spacing == 0 && y % spacing == 0) candidates.push_back(slot);
      }
      std::vector<char> smooth(candidates.size(), 0);
      std::vector<Rgb> between_rgb(candidates.size(), Rgb(0.0f));
      if (!first)
        parallelFor(candidates.size(), 256, threads_, cancel_, [&](size_t begin, size_t end) {
          for (size_t i = begin; i < end; ++i) smooth[i] = isBetween(candidates[i], int(spacing), between_rgb[i]);
        });
      std::vector<uint32_t> slots;
      for (size_t i = 0; i < candidates.size(); ++i)
        if (!smooth[i]) slots.push_back(candidates[i]);
      std::vector<Rgb> values_rgb(slots.size());
      parallelFor(slots.size(), kGrain, threads_, cancel_, [&](size_t begin, size_t end) {
        evaluate_(std::span(slots).subspan(begin, end - begin), std::span(values_rgb).subspan(begin, end - begin));
      });
      evaluated += slots.size();
      for (size_t i = 0; i < slots.size(); ++i) value_rgb_[slots[i]] = values_rgb[i], known_[slots[i]] = 1;
      for (size_t i = 0; i < candidates.size(); ++i)
        if (smooth[i]) value_rgb_[candidates[i]] = between_rgb[i], known_[candidates[i]] = 1;
      if (first) setFloor();
    }
    return std::move(value_rgb_);
  }

 private:
  void setFloor() {
    double sum = 0, count = 0;
    for (size_t slot = 0; slot < value_rgb_.size(); ++slot)
      if (known_[slot]) sum += double(luminance(value_rgb_[slot])), ++count;
    floor_ = count > 0 ? float(kFloor * sum / count) : 0;
  }

  /// The known slot `step` beside a slot, of its chart and orientation; kNone where there is none.
  uint32_t neighbour(uint32_t slot, const Step& step) const {
    const int x = int(atlas_.slots[slot].texel) % atlas_.width + step.x, y = int(atlas_.slots[slot].texel) / atlas_.width + step.y;
    if (x < 0 || y < 0 || x >= atlas_.width || y >= atlas_.height) return kNone;
    const uint32_t other = atlas_.texel_slot[size_t(y) * size_t(atlas_.width) + size_t(x)];
    if (other == kNone || !known_[other] || atlas_.slots[other].chart != atlas_.slots[slot].chart) return kNone;
    return atlas_.slots[other].normal.dot(atlas_.slots[slot].normal) >= kSameNormal ? other : kNone;
  }

  /// Along one line through the slot: the mean of the two neighbours, if it will do.
  bool isSmoothAlong(uint32_t slot, const Step& step, Rgb& mean_rgb, float& distance) const {
    const std::array<uint32_t, 4> line{neighbour(slot, {-3 * step.x, -3 * step.y}), neighbour(slot, {-step.x, -step.y}), neighbour(slot, step),
                                       neighbour(slot, {3 * step.x, 3 * step.y})};
    if (std::ranges::find(line, kNone) != line.end()) return false;
    const Vec3 here = atlas_.slots[slot].position;
    const Vec3 before = atlas_.slots[line[1]].position - here, after = atlas_.slots[line[2]].position - here;
    distance = std::max(before.length(), after.length());
    if ((before + after).length() > kEvenDistance * distance) return false;
    for (int k = 0; k < 3; ++k) {
      const std::array<float, 4> v{value_rgb_[line[0]][k], value_rgb_[line[1]][k], value_rgb_[line[2]][k], value_rgb_[line[3]][k]};
      const float mean = 0.5f * (v[1] + v[2]), scale = mean + floor_;
      // Of a parabola the four differ by 16 times what the mean of the middle two is off by.
      if (!(std::abs(v[0] - v[1] - v[2] + v[3]) <= 16 * options_.curvature * scale)) return false;
      if (!(std::abs(v[2] - v[1]) <= options_.contrast * scale)) return false;
      mean_rgb[k] = mean;
    }
    return true;
  }

  bool isBetween(uint32_t slot, int spacing, Rgb& value_rgb) const {
    const int x = int(atlas_.slots[slot].texel) % atlas_.width, y = int(atlas_.slots[slot].texel) / atlas_.width;
    const bool across_x = x % (2 * spacing) != 0, across_y = y % (2 * spacing) != 0;
    float distance = 0;
    if (across_x && across_y) {
      Rgb one_rgb, other_rgb;
      float other_distance = 0;
      if (!isSmoothAlong(slot, {spacing, spacing}, one_rgb, distance) || !isSmoothAlong(slot, {spacing, -spacing}, other_rgb, other_distance)) return false;
      distance = std::max(distance, other_distance);
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(one_rgb[k] - other_rgb[k]) <= 4 * options_.curvature * (one_rgb[k] + floor_))) return false;
      value_rgb = (one_rgb + other_rgb) * 0.5f;
    } else if (!isSmoothAlong(slot, across_x ? Step{spacing, 0} : Step{0, spacing}, value_rgb, distance)) {
      return false;
    }
    return !isSomethingNear(atlas_.slots[slot], kNear * distance);
  }

  bool isSomethingNear(const atlas::Slot& slot, float distance) const {
    Vec3 tangent, bitangent;
    orthonormalBasis(slot.normal, tangent, bitangent);
    std::array<trace::Ray, 2 * kAround> rays;
    for (int i = 0; i < 2 * kAround; ++i) {
      const float angle = 2 * kPi * (float(i % kAround) + (i < kAround ? 0.0f : 0.5f)) / kAround, sine = kElevationSine[i / kAround], cosine = std::sqrt(1 - sine * sine);
      const Vec3 direction = tangent * (cosine * std::cos(angle)) + bitangent * (cosine * std::sin(angle)) + slot.normal * sine;
      rays[size_t(i)] = {.origin = trace::Tracer::offsetOrigin(slot.position, slot.normal, direction), .direction = direction, .t_max = distance, .key = slot.texel};
    }
    std::array<trace::Hit, 2 * kAround> hits;
    tracer_.closest(rays, hits);
    return std::ranges::any_of(hits, [](const trace::Hit& hit) { return hit.triangle != kNone; });
  }

  const atlas::Atlas& atlas_;
  const trace::Tracer& tracer_;
  const LatticeOptions& options_;
  int threads_;
  const CancelFlag* cancel_;
  const SlotValues& evaluate_;
  std::vector<Rgb> value_rgb_;
  std::vector<char> known_;
  float floor_ = 0;
};

}  // namespace

std::vector<Rgb> valuesOverLattice(const atlas::Atlas& atlas, const trace::Tracer& tracer, const LatticeOptions& options, int threads, const CancelFlag* cancel, const SlotValues& evaluate,
                                   size_t* evaluated) {
  size_t count = 0;
  std::vector<Rgb> values_rgb = Lattice(atlas, tracer, options, threads, cancel, evaluate).fill(count);
  if (evaluated) *evaluated = count;
  return values_rgb;
}

}  // namespace lightwell::transport
