#include "precompute/transport/pooled_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace lightwell::transport {
namespace {

constexpr double kDark = 0.1;         // of the mean: what a dark texel's error is measured against at least
constexpr double kUnlitShare = 1e-4;  // of the mean: a texel is lit when the mean of its channels is above this

double signedRoot(double square) { return std::copysign(std::sqrt(std::abs(square)), square); }

}  // namespace

PooledError compareWithReferences(std::span<const std::vector<Rgb>> references, std::span<const Rgb> candidate) {
  const size_t count = references.size();
  if (count < 3) throw std::logic_error("compareWithReferences: at least three references are needed");
  for (const auto& reference : references)
    if (reference.size() != candidate.size()) throw std::logic_error("compareWithReferences: the maps differ in size");

  std::vector<Vec3d> sum_rgb(candidate.size(), Vec3d(0.0));
  double all = 0;
  for (size_t t = 0; t < candidate.size(); ++t) {
    for (const auto& reference : references) sum_rgb[t] += Vec3d(reference[t]);
    all += sum_rgb[t].x + sum_rgb[t].y + sum_rgb[t].z;
  }
  const double values = 3.0 * double(candidate.size()), mean = all / (double(count) * std::max(1.0, values));

  PooledError error;
  const double pairs = double(count * (count - 1) / 2);
  double square_sum = 0, weighted_sum = 0, reference_square_sum = 0, reference_sum = 0, candidate_sum = 0;
  for (size_t t = 0; t < candidate.size(); ++t) {
    if (!(sum_rgb[t].x + sum_rgb[t].y + sum_rgb[t].z > 3 * double(count) * kUnlitShare * mean)) continue;
    ++error.texels;
    for (int c = 0; c < 3; ++c) {
      const double v = candidate[t][c], sum = sum_rgb[t][c];
      candidate_sum += v;
      reference_sum += sum / double(count);
      for (size_t i = 0; i < count; ++i)
        for (size_t j = i + 1; j < count; ++j) {
          const double a = references[i][t][c], b = references[j][t][c], others = (sum - a - b) / double(count - 2);
          const double product = (v - a) * (v - b) / pairs, scale = std::max(others, 0.0) + kDark * mean;
          square_sum += product;
          weighted_sum += product / (scale * scale);
          reference_square_sum += a * b / pairs;
        }
    }
  }
  if (error.texels == 0 || !(reference_square_sum > 0)) {
    error.relrmse = error.texrel = error.bias = std::numeric_limits<double>::infinity();
    return error;
  }
  error.relrmse = signedRoot(square_sum / reference_square_sum);
  error.texrel = signedRoot(weighted_sum / (3.0 * double(error.texels)));
  error.bias = candidate_sum / reference_sum - 1.0;
  return error;
}

}  // namespace lightwell::transport
