#include "precompute/transport/lightmap/share.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

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

class Sharing {
 public:
  Sharing(const atlas::Atlas& atlas, std::span<const float> exposed, const GatheredPair& gathered) : atlas_(atlas), exposed_(exposed) {
    for (uint32_t slot = 0; slot < atlas.slots.size(); ++slot) {
      const float scale = exposed[slot] >= kLeastExposed ? 1 / exposed[slot] : 1.0f;
      half_rgb_[0].push_back(gathered.a_rgb[slot] * scale);
      half_rgb_[1].push_back(gathered.b_rgb[slot] * scale);
    }
  }

  /// Both halves fitted around a slot at one radius.
  std::array<Rgb, 2> fit(uint32_t slot, int radius) const {
    if (radius == 0 || exposed_[slot] < kLeastExposed) return {half_rgb_[0][slot], half_rgb_[1][slot]};
    const atlas::Slot& center = atlas_.slots[slot];
    Vec3 tangent, bitangent;
    orthonormalBasis(center.normal, tangent, bitangent);
    Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 6> right = Eigen::Matrix<double, 3, 6>::Zero();
    const double scale = 1 / std::sqrt(std::max(1e-30, double(center.area)));
    forNeighbours(slot, radius, [&](uint32_t other, double weight) {
      const Vec3 to = atlas_.slots[other].position - center.position;
      const Eigen::Vector3d basis(1, tangent.dot(to) * scale, bitangent.dot(to) * scale);
      moments += weight * basis * basis.transpose();
      Eigen::Matrix<double, 1, 6> values;
      for (int c = 0; c < 3; ++c) values[c] = half_rgb_[0][other][c], values[3 + c] = half_rgb_[1][other][c];
      right += weight * basis * values;
    });
    // A little stiffness: where slots lie in a row, or alone, the slope is left at zero.
    const double stiffness = 1e-3 * moments(0, 0);
    moments(1, 1) += stiffness, moments(2, 2) += stiffness;
    const Eigen::Matrix<double, 1, 6> value = moments.ldlt().solve(right).row(0);
    std::array<Rgb, 2> result;
    for (int c = 0; c < 3; ++c) result[0][c] = float(std::max(0.0, value[c])), result[1][c] = float(std::max(0.0, value[3 + c]));
    return result;
  }

  /// How badly each half's fit predicts the other half at a slot.
  float error(uint32_t slot, const std::array<Rgb, 2>& fitted) const {
    float sum = 0;
    for (int h = 0; h < 2; ++h) {
      const float difference = luminance(fitted[size_t(h)]) - luminance(half_rgb_[1 - h][slot]);
      sum += difference * difference;
    }
    return sum;
  }

  /// other, weight: of the slots of the same chart and orientation within `radius` texels, itself among them.
  template <class Body>
  void forNeighbours(uint32_t slot, int radius, const Body& body) const {
    const atlas::Slot& center = atlas_.slots[slot];
    const int x = int(center.texel) % atlas_.width, y = int(center.texel) / atlas_.width;
    const double reach2 = (radius + 0.5) * (radius + 0.5);
    for (int ty = std::max(0, y - radius); ty <= std::min(atlas_.height - 1, y + radius); ++ty)
      for (int tx = std::max(0, x - radius); tx <= std::min(atlas_.width - 1, x + radius); ++tx) {
        const double distance2 = double(tx - x) * (tx - x) + double(ty - y) * (ty - y);
        const uint32_t other = atlas_.texel_slot[size_t(ty) * size_t(atlas_.width) + size_t(tx)];
        if (distance2 >= reach2 || other == kNone || exposed_[other] < kLeastExposed) continue;
        const atlas::Slot& there = atlas_.slots[other];
        if (there.chart != center.chart || there.normal.dot(center.normal) < kLeastCosine) continue;
        body(other, (1 - distance2 / reach2) * exposed_[other]);
      }
  }

  /// `shared_rgb`, as far as the slot's own rays allow: what they contradict by more than noise is an edge that fits have run over.
  Rgb believed(uint32_t slot, const Rgb& shared_rgb) const {
    const Rgb own_rgb = (half_rgb_[0][slot] + half_rgb_[1][slot]) * 0.5f;
    double variance = 0, square = 0;  // noise in proportion to the light
    forNeighbours(slot, kNoiseRadius, [&](uint32_t other, double weight) {
      const double a = luminance(half_rgb_[0][other]), b = luminance(half_rgb_[1][other]);
      variance += weight * (a - b) * (a - b) / 4;
      square += weight * (a + b) * (a + b) / 4;
    });
    const double difference = std::abs(double(luminance(shared_rgb)) - luminance(own_rgb));
    const double relative = square > 0 ? std::sqrt(variance / square) : 0.0;
    const double most = kMostDeviation * relative * (luminance(shared_rgb) + luminance(own_rgb)) / 2;
    return difference <= most ? shared_rgb : own_rgb + (shared_rgb - own_rgb) * float(most / difference);
  }
  float scale(uint32_t slot) const { return exposed_[slot] >= kLeastExposed ? exposed_[slot] : 1.0f; }

 private:
  const atlas::Atlas& atlas_;
  std::span<const float> exposed_;
  std::vector<Rgb> half_rgb_[2];  // irradiance of the exposed part
};

}  // namespace

std::vector<Rgb> shareIrradiance(const atlas::Atlas& atlas, std::span<const float> exposed, const GatheredPair& gathered, int threads, const CancelFlag* cancel) {
  const Sharing sharing(atlas, exposed, gathered);
  const size_t slots = atlas.slots.size();
  struct Fits {
    std::array<Rgb, kRadii.size()> value_rgb;
    std::array<float, kRadii.size()> error;
  };
  std::vector<Fits> fits(slots);
  parallelFor(slots, 256, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot)
      for (size_t r = 0; r < kRadii.size(); ++r) {
        const auto fitted = sharing.fit(uint32_t(slot), kRadii[r]);
        fits[slot].value_rgb[r] = (fitted[0] + fitted[1]) * 0.5f;
        fits[slot].error[r] = sharing.error(uint32_t(slot), fitted);
      }
  });
  std::vector<uint8_t> radius(slots, 0);  // index into kRadii
  parallelFor(slots, 256, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      if (exposed[slot] < kLeastExposed) continue;
      std::array<double, kRadii.size()> error{};
      sharing.forNeighbours(uint32_t(slot), kErrorRadius, [&](uint32_t other, double weight) {
        for (size_t r = 0; r < kRadii.size(); ++r) error[r] += weight * fits[other].error[r];
      });
      radius[slot] = uint8_t(std::min_element(error.begin(), error.end()) - error.begin());
    }
  });
  std::vector<Rgb> irradiance_rgb(slots);
  parallelFor(slots, 256, threads, cancel, [&](size_t begin, size_t end) {
    for (size_t slot = begin; slot < end; ++slot) {
      Rgb value_rgb = fits[slot].value_rgb[radius[slot]];
      if (radius[slot] > 0) {
        // What the fits around have left over is noise, and on average what they bend wrongly (twicing: Tukey, "Exploratory Data Analysis", 1977).
        Vec3d left(0.0);
        double weights = 0;
        sharing.forNeighbours(uint32_t(slot), kRestRadius, [&](uint32_t other, double weight) {
          left += Vec3d(fits[other].value_rgb[0] - fits[other].value_rgb[radius[other]]) * weight;
          weights += weight;
        });
        for (int c = 0; c < 3; ++c) value_rgb[c] = std::max(0.0f, value_rgb[c] + float(left[c] / weights));
        value_rgb = sharing.believed(uint32_t(slot), value_rgb);
      }
      irradiance_rgb[slot] = value_rgb * sharing.scale(uint32_t(slot));
    }
  });
  return irradiance_rgb;
}

}  // namespace lightwell::transport
