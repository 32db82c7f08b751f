#include "precompute/transport/environment/reflectivity.h"

#include <algorithm>

namespace lightwell::transport {
namespace {

constexpr float kTwoPi = 2 * kPi;
constexpr float kInvSqrt2 = 0.70710678f, kInvSqrt2Pi = 0.39894228f;

/// 1 − a · b without cancellation for close vectors.
float oneMinusCosine(const Vec3& a, const Vec3& b) { return 0.5f * (a - b).length2(); }

/// cos^n from 1 − cos.
float powerOf(float one_minus_cosine, float n) { return one_minus_cosine < 1 ? std::exp(n * std::log1p(-one_minus_cosine)) : 0.0f; }

/// Concentration κ of a von Mises–Fisher distribution whose mean cosine is 1 − spread: coth κ − 1/κ = 1 − spread.
/// Banerjee et al. 2005, equation 4.4, then Newton's method; κ ≈ 1 / spread when the spread is small.
float concentration(float spread) {
  if (spread < 1e-3f) return 1 / std::max(spread, 1e-12f);
  const double mean = 1 - double(spread);
  double kappa = mean * (3 - mean * mean) / (1 - mean * mean);
  for (int step = 0; step < 3 && kappa > 1e-2; ++step) {
    const double coth = 1 / std::tanh(kappa), value = coth - 1 / kappa;
    kappa -= (value - mean) / (1 - coth * coth + 1 / (kappa * kappa));
  }
  return float(std::max(kappa, 0.0));
}

float paperAverage(const CellShape& cell, const Vec3& mirror, float n) {
  const float to_center = oneMinusCosine(cell.direction, mirror), to_rim = cell.solid_angle_sr / kTwoPi;
  const float single = powerOf(to_center, n);
  if (to_center >= to_rim) return single;
  const float t = to_center / to_rim;
  return capAverageAtCenter(cell.solid_angle_sr, n) * (1 - t) + single * t;
}

float vmfAverage(const CellShape& cell, const Vec3& mirror, float n) {
  const float kappa = std::max(concentration(cell.spread), 1e-4f), chord2 = (cell.direction - mirror).length2();
  // The product of two lobes is a lobe about κ c + n R of length ρ; ρ − κ − n without cancellation from ρ² = (κ + n)² − κ n |c − R|².
  const float sum = kappa + n, rho = std::sqrt(std::max(0.0f, sum * sum - kappa * n * chord2));
  const float exponent = -kappa * n * chord2 / (rho + sum);
  const float integral = rho > 1e-3f ? -std::expm1(-2 * rho) / rho : 2.0f;
  const float same_energy = n / ((n + 1) * -std::expm1(-2 * n));  // so that the lobe integrates to 2π / (n + 1)
  return std::min(1.0f, kappa / -std::expm1(-2 * kappa) * integral * std::exp(exponent) * same_energy);
}

/// cos^n ψ = (1 + tan² ψ)^(−n/2), and tan² ψ = t · t for the gnomonic offset t of R from the cell's axis. Folding a Gaussian exp(−n t·t/2)
/// with covariance S gives det(I + n S)^(−1/2) exp(−n t·(I + n S)⁻¹t / 2). The same form with (n − 1) / cos² ψ for the second n also has
/// the right second derivatives of cos^n at every ψ: to first order in S the mean is exact, n = 1 and n = 1e5 alike.
float spreadAverage(const CellShape& cell, const Vec3& mirror, float n) {
  const float cosine = cell.direction.dot(mirror);
  if (cosine <= 1e-4f) return 0;
  Vec3 tangent, bitangent;
  orthonormalBasis(cell.direction, tangent, bitangent);
  const Vec3 offset = mirror - cell.direction;  // no cancellation: tangents are orthogonal to the direction
  const float x = offset.dot(tangent) / cosine, y = offset.dot(bitangent) / cosine;
  const auto& [xx, xy, yy] = cell.covariance;
  const float k = (n - 1) / (cosine * cosine);
  const float a = 1 + k * xx, b = k * xy, d = 1 + k * yy;
  const float form = std::max(0.0f, (d * x * x - 2 * b * x * y + a * y * y) / std::max(1.0f, a * d - b * b));
  const float widening = std::max(1.0f, (1 + n * xx) * (1 + n * yy) - n * n * xy * xy);
  return std::exp(-0.5f * n * std::log1p(form)) / std::sqrt(widening);
}

}  // namespace

CellShape cellShape(const EnvironmentCells& cells, uint32_t i) {
  return {cells.direction[i], cells.solid_angle_sr[i], cells.spread[i], cells.covariance[i]};
}

float cosinePower(const Vec3& a, const Vec3& b, float n) { return powerOf(oneMinusCosine(a, b), n); }

float capAverageAtCenter(float solid_angle_sr, float n) {
  const float depth = std::max(solid_angle_sr / kTwoPi, 1e-30f);  // 1 − cos r
  const float missed = depth < 1 ? -std::expm1((n + 1) * std::log1p(-depth)) : 1.0f;
  return std::min(1.0f, missed / ((n + 1) * depth));
}

float averageCosinePower(Reflectivity model, const CellShape& cell, const Vec3& mirror, float n) {
  switch (model) {
    case Reflectivity::single: return cosinePower(cell.direction, mirror, n);
    case Reflectivity::paper: return paperAverage(cell, mirror, n);
    case Reflectivity::vmf: return vmfAverage(cell, mirror, n);
    case Reflectivity::spread: return spreadAverage(cell, mirror, n);
  }
  return 0;
}

float averageCosine(Reflectivity model, const CellShape& cell, const Vec3& normal) {
  const float cosine = cell.direction.dot(normal);
  if (model != Reflectivity::spread) return std::max(0.0f, cosine);
  // Height above the horizon: mean (1 − spread) cos θ; variance from the tangent plane, n' S n.
  Vec3 tangent, bitangent;
  orthonormalBasis(cell.direction, tangent, bitangent);
  const float x = normal.dot(tangent), y = normal.dot(bitangent), mean = (1 - cell.spread) * cosine;
  const float variance = cell.covariance[0] * x * x + 2 * cell.covariance[1] * x * y + cell.covariance[2] * y * y;
  if (!(variance > 1e-12f)) return std::max(0.0f, mean);
  const float deviation = std::sqrt(variance), z = mean / deviation;
  return std::max(0.0f, 0.5f * mean * std::erfc(-z * kInvSqrt2) + deviation * kInvSqrt2Pi * std::exp(-0.5f * z * z));
}

}  // namespace lightwell::transport
