#include "precompute/transport/compare.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "precompute/core/error.h"

namespace lightwell::transport {
namespace {

constexpr double kDark = 0.1;         // of the mean: what a dark texel's error is measured against at least
constexpr double kQuantile95 = 1.96;  // standard errors of a 95 % interval
constexpr double kUnlitShare = 1e-4;  // of the mean: a texel is lit when the sum of its channels is above this

bool isFiniteRgb(const std::array<float, 4>& p) { return std::isfinite(p[0]) && std::isfinite(p[1]) && std::isfinite(p[2]); }

/// The value below which the share `q` of `values` lies, linear between neighbours. Reorders `values`.
double quantile(std::vector<double>& values, double q) {
  const double place = q * double(values.size() - 1);
  const size_t below = size_t(place);
  std::nth_element(values.begin(), values.begin() + below, values.end());
  const double low = values[below];
  if (below + 1 == values.size()) return low;
  const double high = *std::min_element(values.begin() + below + 1, values.end());
  return low + (place - double(below)) * (high - low);
}

}  // namespace

MapError compareMaps(const ImageRgba& reference, const ImageRgba& candidate, const ImageRgba* reference_b) {
  const auto requireSize = [&](const ImageRgba& other, const char* name) {
    if (other.width != reference.width || other.height != reference.height)
      throw UsageError("the maps differ in size: the reference has " + std::to_string(reference.width) + " x " +
                       std::to_string(reference.height) + " texels, the " + name + " " + std::to_string(other.width) + " x " + std::to_string(other.height));
  };
  requireSize(candidate, "candidate");
  if (reference_b) requireSize(*reference_b, "second reference");
  const ImageRgba& second = reference_b ? *reference_b : reference;

  MapError error;
  std::vector<size_t> covered;
  double absolute_sum = 0;
  for (size_t i = 0; i < reference.pixels.size(); ++i) {
    const auto& r = reference.pixels[i];
    if (!(r[3] > 0.5f) || !isFiniteRgb(r) || !isFiniteRgb(second.pixels[i])) continue;
    if (!(candidate.pixels[i][3] > 0.5f)) {
      ++error.missing;
      continue;
    }
    covered.push_back(i);
    for (int c = 0; c < 3; ++c) absolute_sum += std::abs(double(r[c]));
  }
  const double lit_threshold = covered.empty() ? 0.0 : kUnlitShare * absolute_sum / (3.0 * double(covered.size()));

  std::vector<size_t> compared;
  double reference_sum = 0, reference_square_sum = 0, candidate_sum = 0;
  for (const size_t i : covered) {
    const auto &a = reference.pixels[i], &b = second.pixels[i], &v = candidate.pixels[i];
    if (!(std::abs(double(a[0])) + std::abs(double(a[1])) + std::abs(double(a[2])) > lit_threshold)) continue;
    if (!isFiniteRgb(v)) {
      ++error.nonfinite;
      continue;
    }
    if (v[0] < 0 || v[1] < 0 || v[2] < 0) ++error.negative;
    compared.push_back(i);
    for (int c = 0; c < 3; ++c) {
      reference_sum += 0.5 * (double(a[c]) + b[c]);
      reference_square_sum += double(a[c]) * b[c];  // without the noise of two references
      candidate_sum += v[c];
    }
  }
  error.texels = compared.size();
  if (compared.empty()) {
    error.relrmse = error.relrmse_low = error.relrmse_high = error.texrel = error.bias = error.p99 = error.max = std::numeric_limits<double>::infinity();
    return error;
  }

  const double values = 3.0 * double(compared.size()), mean = reference_sum / values, rms = std::sqrt(reference_square_sum / values);
  double square_sum = 0, texel_square2_sum = 0, weighted_square_sum = 0, greatest = 0;
  std::vector<double> texel_error;
  for (const size_t i : compared) {
    double texel_greatest = 0, texel_square = 0;
    for (int c = 0; c < 3; ++c) {
      const double a = reference.pixels[i][c], b = second.pixels[i][c], v = candidate.pixels[i][c], truth = 0.5 * (a + b);
      const double square = (v - a) * (v - b), scale = std::max(truth, 0.0) + kDark * mean;
      texel_square += square;
      weighted_square_sum += square / (scale * scale);
      texel_greatest = std::max(texel_greatest, std::abs(v - truth));
    }
    square_sum += texel_square, texel_square2_sum += texel_square * texel_square;
    texel_error.push_back(texel_greatest / rms);
    greatest = std::max(greatest, texel_greatest / rms);
  }
  // Against two references the sums estimate a square and may fall below zero; the sign is kept so that their mean stays unbiased.
  const auto signedRootOfMean = [&](double sum) { return std::copysign(std::sqrt(std::abs(sum) / values), sum); };
  const double texels = double(compared.size());
  const double spread = kQuantile95 * std::sqrt(std::max(texel_square2_sum - square_sum * square_sum / texels, 0.0) * texels / std::max(texels - 1, 1.0));
  error.relrmse = signedRootOfMean(square_sum) / rms;
  error.relrmse_low = signedRootOfMean(square_sum - spread) / rms, error.relrmse_high = signedRootOfMean(square_sum + spread) / rms;
  error.texrel = signedRootOfMean(weighted_square_sum);
  error.bias = candidate_sum / reference_sum - 1.0;
  error.p99 = quantile(texel_error, 0.99);
  error.max = greatest;
  return error;
}

}  // namespace lightwell::transport
