#include "precompute/transport/environment/ggx_lobes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>

namespace lightwell::transport {
namespace {

constexpr float kLeastRoughness = 0.075f;  // sharper lobes than shininess 1e5 would be needed below
// Shininess of the lobes over (1 − α²) / 2α². Near its peak the kernel is 1 / (1 + y)², y = (1 − cos ψ)(1 − α²) / 2α², a mixture of exp(−t
// y) with density t exp(−t): these t cover it.
constexpr std::array kMixture = {0.08, 0.4, 1.5, 5.0};
constexpr int kPoints = 1024;

/// cos ψ · D(ψ/2) up to a factor.
double kernel(double one_minus_cosine, double alpha2) {
  const double d = alpha2 + 0.5 * (1 - alpha2) * one_minus_cosine;
  return (1 - one_minus_cosine) / (d * d);
}

}  // namespace

std::vector<PhongLobe> ggxLobes(float roughness) {
  const double alpha = std::pow(double(std::clamp(roughness, kLeastRoughness, 1.0f)), 2), alpha2 = alpha * alpha;
  std::vector<double> shininess;
  for (double t : kMixture) shininess.push_back(1 + t * (1 - alpha2) / (2 * alpha2));
  // Points by equal steps in the logarithm of 1 − cos ψ + α² / 100: dense at the peak.
  const double offset = 0.01 * alpha2, steps = std::log((1 + offset) / offset) / kPoints;
  Eigen::VectorXd weight;
  for (;;) {  // least squares relative to the kernel; lobes that would subtract light are left out, the worst first
    const int lobes = int(shininess.size());
    Eigen::MatrixXd a = Eigen::MatrixXd::Zero(lobes, lobes);
    Eigen::VectorXd b = Eigen::VectorXd::Zero(lobes), value(lobes);
    for (int p = 0; p < kPoints; ++p) {
      const double depth = offset * std::expm1((p + 0.5) * steps), width = (depth + offset) * steps;
      for (int i = 0; i < lobes; ++i) value[i] = std::exp(shininess[size_t(i)] * std::log1p(-depth));
      a += value * value.transpose() * (width / kernel(depth, alpha2));
      b += value * width;
    }
    weight = a.completeOrthogonalDecomposition().solve(b);
    int worst = 0;
    if (lobes == 1 || weight.minCoeff(&worst) > 0) break;
    shininess.erase(shininess.begin() + worst);
  }
  double total = 0;
  for (size_t i = 0; i < shininess.size(); ++i) total += weight[long(i)] / (shininess[i] + 1);
  std::vector<PhongLobe> lobes;
  for (size_t i = 0; i < shininess.size(); ++i) lobes.push_back({float(weight[long(i)] / (shininess[i] + 1) / total), float(shininess[i])});
  return lobes;
}

}  // namespace lightwell::transport
