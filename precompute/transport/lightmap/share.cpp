#include "precompute/transport/lightmap/share.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "precompute/core/parallel.h"

namespace lightwell::transport {
namespace {

constexpr std::array<int, 5> kRadii = {0, 1, 2, 4, 8};  // texels
constexpr int kRestRadius = 6;                          // texels over which what fits leave over is averaged
constexpr int kErrorRadius = 3;                         // texels over which errors are averaged
constexpr int kNoiseRadius = 4;                         // texels over which noise is measured
constexpr float kMostDeviation = 3;                     // of a shared value from a slot's own, in standard errors
constexpr float kLeastCosine = 0.9f;                    // between normals of slots that share
constexpr float kLeastExposed = 0.25f;                  // hidden slots neither give nor take

/// What a fit needs to know of a texel, side by side.
struct Place {
  Vec3 position, normal;
  float share = 0;  // exposed; 0: neither gives nor takes
  uint32_t slot = kNone, chart = 0;
};

/// The values of both halves.
using Halves = Eigen::Array<float, 8, 1>;  // a_rgb, 0, b_rgb, 0

/// Normal equations of one fit: moments of (1, s, t), where s and t are places in the tangent plane, and of their products with the values.
struct Fit {
  float one = 0, s = 0, t = 0, ss = 0, st = 0, tt = 0;
  Halves value = Halves::Zero(), s_value = Halves::Zero(), t_value = Halves::Zero();

  void add(float weight, float at_s, float at_t, const Halves& values) {
    const float ws = weight * at_s, wt = weight * at_t;
    one += weight, s += ws, t += wt, ss += ws * at_s, st += ws * at_t, tt += wt * at_t;
    value += weight * values, s_value += ws * values, t_value += wt * values;
  }
  /// At (0, 0): by Cramer's rule.
  Halves center() const {
    // A little stiffness: where slots lie in a row, or alone, the slope is left at zero.
    const float a = ss + 1e-3f * one, b = tt + 1e-3f * one;
    const float determinant = one * (a * b - st * st) - s * (s * b - t * st) + t * (s * st - t * a);
    if (!(determinant > 1e-9f * one * a * b)) return value / one;
    const Halves fitted = ((a * b - st * st) * value + (t * st - s * b) * s_value + (s * st - t * a) * t_value) / determinant;
    return fitted.max(0.0f);
  }
};

float luminanceOf(const Halves& values, int half) { return luminance(Rgb(values[4 * half], values[4 * half + 1], values[4 * half + 2])); }
Rgb meanOf(const Halves& values) { return (Rgb(values[0], values[1], values[2]) + Rgb(values[4], values[5], values[6])) * 0.5f; }

class Sharing {
 public:
  Sharing(const atlas::Atlas& atlas, std::span<const float> exposed, const GatheredPair& gathered) : atlas_(atlas), exposed_(exposed), gathered_(gathered) {
    places_.resize(atlas.texel_slot.size());
    halves_.resize(atlas.slots.size());
    for (uint32_t slot = 0; slot < atlas.slots.size(); ++slot) {
      const atlas::Slot& at = atlas.slots[slot];
      places_[at.texel] = {at.position, at.normal, shares(slot) ? exposed[slot] : 0.0f, slot, at.chart};
      const float factor = 1 / scale(slot);
      const Rgb a = gathered.a_rgb[slot] * factor, b = gathered.b_rgb[slot] * factor;
      halves_[slot] << a.x, a.y, a.z, 0, b.x, b.y, b.z, 0;
    }
    for (int y = -kMostRadius; y <= kMostRadius; ++y)
      for (int x = -kMostRadius; x <= kMostRadius; ++x) offsets_.push_back({x, y, float(x * x + y * y)});
    std::stable_sort(offsets_.begin(), offsets_.end(), [](const Offset& p, const Offset& q) { return p.distance2 < q.distance2; });
  }

  bool shares(uint32_t slot) const { return exposed_[slot] >= kLeastExposed; }
  float scale(uint32_t slot) const { return shares(slot) ? exposed_[slot] : 1.0f; }
  const Halves& halves(uint32_t slot) const { return halves_[slot]; }

  /// Both halves fitted around a slot at each radius.
  std::array<Halves, kRadii.size()> fit(uint32_t slot) const {
    std::array<Halves, kRadii.size()> values;
    values.fill(halves_[slot]);
    if (!shares(slot)) return values;
    const atlas::Slot& center = atlas_.slots[slot];
    Vec3 tangent, bitangent;
    orthonormalBasis(center.normal, tangent, bitangent);
    const float scale = 1 / std::sqrt(std::max(1e-30f, center.area));
    std::array<Fit, kRadii.size()> fits;
    forNeighbours(slot, kMostRadius, [&](const Place& there, float distance2) {
      const Vec3 to = there.position - center.position;
      const float s = tangent.dot(to) * scale, t = bitangent.dot(to) * scale;
      for (size_t r = kRadii.size() - 1; r > 0 && distance2 < reach2(kRadii[r]); --r)
        fits[r].add((1 - distance2 / reach2(kRadii[r])) * there.share, s, t, halves_[there.slot]);
    });
    for (size_t r = 1; r < kRadii.size(); ++r) values[r] = fits[r].center();
    return values;
  }

  /// How badly each half's fit predicts the other half at a slot.
  float error(uint32_t slot, const Halves& fitted) const {
    const float a = luminanceOf(fitted, 0) - luminanceOf(halves_[slot], 1), b = luminanceOf(fitted, 1) - luminanceOf(halves_[slot], 0);
    return a * a + b * b;
  }

  /// place, square of the distance in texels: of the slots of the same chart and orientation within `radius` texels, itself among them.
  template <class Body>
  void forNeighbours(uint32_t slot, int radius, const Body& body) const {
    const atlas::Slot& center = atlas_.slots[slot];
    const int x = int(center.texel) % atlas_.width, y = int(center.texel) / atlas_.width;
    for (const Offset& offset : offsets_) {
      if (offset.distance2 >= reach2(radius)) break;
      const int tx = x + offset.x, ty = y + offset.y;
      if (tx < 0 || ty < 0 || tx >= atlas_.width || ty >= atlas_.height) continue;
      const Place& there = places_[size_t(ty) * size_t(atlas_.width) + size_t(tx)];
      if (there.share == 0.0f || there.chart != center.chart || there.normal.dot(center.normal) < kLeastCosine) continue;
      body(there, offset.distance2);
    }
  }
  /// other, weight: the same with a weight that falls to zero at the radius.
  template <class Body>
  void forWeighted(uint32_t slot, int radius, const Body& body) const {
    forNeighbours(slot, radius, [&](const Place& there, float distance2) { body(there.slot, double((1 - distance2 / reach2(radius)) * there.share)); });
  }

  /// `shared_rgb`, as far as the slot's own rays allow: what they contradict by more than noise is an edge that fits have run over.
  Rgb believed(uint32_t slot, const Rgb& shared_rgb) const {
    const Rgb own_rgb = meanOf(halves_[slot]);
    double variance = 0, square = 0;  // noise in proportion to the light
    forWeighted(slot, kNoiseRadius, [&](uint32_t other, double weight) {
      const double a = luminanceOf(halves_[other], 0), b = luminanceOf(halves_[other], 1);
      variance += weight * (a - b) * (a - b) / 4;
      square += weight * (a + b) * (a + b) / 4;
    });
    const double difference = std::abs(double(luminance(shared_rgb)) - luminance(own_rgb));
    const double relative = square > 0 ? std::sqrt(variance / square) : 0.0;
    const double most = kMostDeviation * relative * (luminance(shared_rgb) + luminance(own_rgb)) / 2;
    return difference <= most ? shared_rgb : own_rgb + (shared_rgb - own_rgb) * float(most / difference);
  }

  Vec3 gradient(uint32_t slot, int radius) const {
    if (radius == 0) return gathered_.gradient[slot];
    Vec3d sum(0.0);
    double weights = 0;
    forWeighted(slot, radius, [&](uint32_t other, double weight) {
      sum += Vec3d(gathered_.gradient[other]) * (weight / scale(other));
      weights += weight;
    });
    return Vec3(sum * (scale(slot) / weights));
  }

 private:
  static constexpr int kMostRadius = kRadii.back();
  struct Offset {
    int x, y;
    float distance2;
  };
  static constexpr float reach2(int radius) { return (float(radius) + 0.5f) * (float(radius) + 0.5f); }

  const atlas::Atlas& atlas_;
  std::span<const float> exposed_;
  const GatheredPair& gathered_;
  std::vector<Place> places_;   // by texel
  std::vector<Halves> halves_;  // by slot, of the exposed part
  std::vector<Offset> offsets_;  // by distance
};

}  // namespace

SharedLight shareIrradiance(const atlas::Atlas& atlas, std::span<const float> exposed, const GatheredPair& gathered, int threads, const CancelFlag* cancel) {
  const Sharing sharing(atlas, exposed, gathered);
  const size_t slots = atlas.slots.size();
  struct Fits {
    std::array<Rgb, kRadii.size()> value_rgb;
    std::array<float, kRadii.size()> error;
  };
  std::vector<Fits> fits(slots);
  parallelFor(slots, 256, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      const auto fitted = sharing.fit(uint32_t(slot));
      for (size_t r = 0; r < kRadii.size(); ++r) {
        fits[slot].value_rgb[r] = meanOf(fitted[r]);
        fits[slot].error[r] = sharing.error(uint32_t(slot), fitted[r]);
      }
    }
  });
  std::vector<uint8_t> radius(slots, 0);  // index into kRadii
  parallelFor(slots, 256, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      if (!sharing.shares(uint32_t(slot))) continue;
      std::array<double, kRadii.size()> error{};
      sharing.forWeighted(uint32_t(slot), kErrorRadius, [&](uint32_t other, double weight) {
        for (size_t r = 0; r < kRadii.size(); ++r) error[r] += weight * double(fits[other].error[r]);
      });
      radius[slot] = uint8_t(std::min_element(error.begin(), error.end()) - error.begin());
    }
  });
  SharedLight light;
  light.irradiance_rgb.resize(slots);
  if (!gathered.gradient.empty()) light.gradient.resize(slots);
  parallelFor(slots, 256, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      Rgb value_rgb = fits[slot].value_rgb[radius[slot]];
      if (radius[slot] > 0) {
        // What the fits around have left over is noise, and on average what they bend wrongly (twicing: Tukey, "Exploratory Data Analysis", 1977).
        Vec3d left(0.0);
        double weights = 0;
        sharing.forWeighted(uint32_t(slot), kRestRadius, [&](uint32_t other, double weight) {
          left += Vec3d(fits[other].value_rgb[0] - fits[other].value_rgb[radius[other]]) * weight;
          weights += weight;
        });
        for (int c = 0; c < 3; ++c) value_rgb[c] = std::max(0.0f, value_rgb[c] + float(left[c] / weights));
        value_rgb = sharing.believed(uint32_t(slot), value_rgb);
      }
      light.irradiance_rgb[slot] = value_rgb * sharing.scale(uint32_t(slot));
      if (!light.gradient.empty()) light.gradient[slot] = sharing.gradient(uint32_t(slot), kRadii[radius[slot]]);
    }
  });
  return light;
}

}  // namespace lightwell::transport
