#include "precompute/transport/lightmap/measure_lightmap.h"

#include <algorithm>
#include <cmath>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kChoiceStream = 14ull << 40;
constexpr double kDark = 0.1;         // of the mean: what a dark texel's error is measured against at least
constexpr double kUnlitShare = 1e-4;  // of the mean: texels below are not compared
constexpr double kDeviations = 2.0;   // of the interval

/// The root of Σ weight × above ÷ Σ weight × below.
EstimatedError rootOfRatio(std::span<const float> weight, std::span<const double> above, std::span<const double> below) {
  double numerator = 0, denominator = 0;
  for (size_t i = 0; i < weight.size(); ++i) numerator += double(weight[i]) * above[i], denominator += double(weight[i]) * below[i];
  if (!(denominator > 0)) return {};
  const double ratio = numerator / denominator;
  double scatter = 0;
  for (size_t i = 0; i < weight.size(); ++i) scatter += std::pow(double(weight[i]) * (above[i] - ratio * below[i]), 2.0);
  const double count = double(weight.size());
  const double deviation = kDeviations * std::sqrt(scatter * count / std::max(1.0, count - 1)) / denominator;
  const auto root = [](double square) { return std::sqrt(std::max(0.0, square)); };
  return {root(ratio), root(ratio - deviation), root(ratio + deviation)};
}

}  // namespace

MeasuredTexels chooseTexels(std::span<const uint32_t> density, uint32_t most, uint64_t seed) {
  MeasuredTexels chosen;
  if (density.size() <= most) {
    for (uint32_t slot = 0; slot < density.size(); ++slot) chosen.slot.push_back(slot), chosen.weight.push_back(1);
    return chosen;
  }
  double total = 0;
  for (const uint32_t d : density) total += d;
  // At equal steps through the sum: neighbours are not all chosen together.
  double next = (double(Sampler(seed, kChoiceStream).get1D(0, 0)) + 1e-9) * total / most, sum = 0;
  for (uint32_t slot = 0; slot < density.size(); ++slot) {
    sum += density[slot];
    uint32_t times = 0;
    for (; next < sum; next += total / most) ++times;
    if (times == 0) continue;
    chosen.slot.push_back(slot);
    chosen.weight.push_back(float(times * (total / most) / density[slot]));
  }
  return chosen;
}

LightmapError measureLightmap(std::span<const std::vector<Rgb>> references, std::span<const Rgb> candidate_rgb, std::span<const float> weight) {
  const size_t count = references.size(), texels = candidate_rgb.size();
  double sum = 0, weights = 0;
  for (size_t t = 0; t < texels; ++t)
    for (const auto& reference : references)
      for (int c = 0; c < 3; ++c) sum += double(weight[t]) * double(reference[t][c]), weights += weight[t];
  const double mean = weights > 0 ? sum / weights : 0;
  LightmapError error;
  if (!(mean > 0)) return error;
  const double pairs = double(count * (count - 1) / 2);
  std::vector<float> lit_weight;
  std::vector<double> square, relative, reference_square, one;
  double candidate_sum = 0, reference_sum = 0;
  for (size_t t = 0; t < texels; ++t) {
    Vec3d all(0.0);
    for (const auto& reference : references) all += Vec3d(reference[t]);
    if (!(all.x + all.y + all.z > 3 * double(count) * kUnlitShare * mean)) continue;
    lit_weight.push_back(weight[t]);
    double s = 0, q = 0, r = 0;
    for (int c = 0; c < 3; ++c) {
      const double v = candidate_rgb[t][c];
      candidate_sum += double(weight[t]) * v, reference_sum += double(weight[t]) * all[c] / double(count);
      for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count; ++j) {
          const double a = references[i][t][c], b = references[j][t][c], others = (all[c] - a - b) / double(count - 2);
          const double product = (v - a) * (v - b) / pairs, scale = std::max(others, 0.0) + kDark * mean;
          s += product, q += product / (scale * scale), r += a * b / pairs;
        }
    }
    square.push_back(s), relative.push_back(q / 3), reference_square.push_back(r), one.push_back(1);
  }
  error.texels = lit_weight.size();
  error.relrmse = rootOfRatio(lit_weight, square, reference_square);
  error.texrel = rootOfRatio(lit_weight, relative, one);
  error.bias = reference_sum > 0 ? candidate_sum / reference_sum - 1 : 0;
  return error;
}

}  // namespace lightwell::transport
