#include "cli/report/truth.h"

#include <cmath>

#include "precompute/transport/compare.h"

namespace lightwell::report {
namespace {

constexpr double kQuantile95 = 1.96;

bool covered(const ImageRgba& image, size_t i) { return image.pixels[i][3] > 0.5f; }

}  // namespace

void describeNoise(const Truth& truth, Reference& reference) {
  double texels = 0, sum = 0, product = 0, difference2 = 0, fourth = 0;
  for (size_t i = 0; i < truth.first.pixels.size(); ++i) {
    if (!covered(truth.first, i)) continue;
    double variance = 0;  // of one reference, summed over channels
    for (size_t c = 0; c < 3; ++c) {
      const double a = double(truth.first.pixels[i][c]), b = double(truth.second.pixels[i][c]);
      product += a * b, sum += 0.5 * (a + b), difference2 += (a - b) * (a - b), variance += 0.5 * (a - b) * (a - b);
    }
    fourth += variance * variance, ++texels;
  }
  if (!(texels > 0) || !(product > 0)) return;
  reference.mean_irradiance = sum / (3 * texels);
  reference.noise = 0.5 * std::sqrt(difference2 / product);
  reference.resolution = std::sqrt(kQuantile95 * std::sqrt(fourth) / product);
}

void compareWith(const Truth& truth, const ImageRgba& map, Evaluated& e) {
  const transport::MapError error = transport::compareMaps(truth.first, map, &truth.second);
  e.texels = error.texels;
  e.relrmse = error.relrmse, e.texrel = error.texrel, e.bias = error.bias, e.p99 = error.p99, e.max = error.max;
  e.relrmse_low = error.relrmse_low, e.relrmse_high = error.relrmse_high;
}

std::pair<int, int> worstTexel(const Truth& truth, const ImageRgba& map) {
  std::pair<int, int> worst{-1, -1};
  double most = -1;
  for (size_t i = 0; i < map.pixels.size(); ++i) {
    if (!covered(truth.first, i) || !covered(map, i)) continue;
    for (size_t c = 0; c < 3; ++c) {
      const double error = std::abs(double(map.pixels[i][c]) - 0.5 * (double(truth.first.pixels[i][c]) + double(truth.second.pixels[i][c])));
      if (error > most) most = error, worst = {int(i % size_t(map.width)), int(i / size_t(map.width))};
    }
  }
  return worst;
}

}  // namespace lightwell::report
