#include "precompute/transport/environment/ggx_lobes.h"

#include <gtest/gtest.h>

#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/evaluate_environment.h"
#include "tests/environment/skies.h"

namespace lightwell::transport {
namespace {

constexpr double kPiD = std::numbers::pi;

/// The prefilter's kernel from the textbook form of GGX: D(h) cos ψ with the half vector at ψ / 2.
double ggxKernel(double psi, double alpha) {
  const double c = std::cos(psi / 2), d = c * c * (alpha * alpha - 1) + 1;
  return alpha * alpha / (kPiD * d * d) * std::cos(psi);
}

TEST(GgxLobes, FollowTheKernel) {
  for (const auto& [roughness, limit] : {std::pair{0.0f, 0.06}, std::pair{0.15f, 0.04}, std::pair{0.3f, 0.025}, std::pair{0.5f, 0.015},
                                         std::pair{0.8f, 0.01}, std::pair{1.0f, 0.001}}) {
    const double alpha = std::pow(std::max(0.075, double(roughness)), 2);
    const std::vector<PhongLobe> lobes = ggxLobes(roughness);
    double energy = 0, difference = 0, weight = 0;
    for (const PhongLobe& lobe : lobes) {
      EXPECT_GT(lobe.weight, 0);
      EXPECT_LE(lobe.shininess, 1e5f);
      weight += lobe.weight;
    }
    const int steps = 200000;
    const auto overSphere = [&](const auto& f) {
      double sum = 0;
      for (int i = 0; i < steps; ++i) {
        const double s = (i + 0.5) / steps, psi = s * s * s * kPiD / 2;  // dense at the peak
        sum += f(psi) * 2 * kPiD * std::sin(psi) * 3 * s * s * kPiD / 2 / steps;
      }
      return sum;
    };
    energy = overSphere([&](double psi) { return ggxKernel(psi, alpha); });
    difference = overSphere([&](double psi) {
      double fit = 0;
      for (const PhongLobe& lobe : lobes)
        fit += lobe.weight * (double(lobe.shininess) + 1) / (2 * kPiD) * std::exp(lobe.shininess * std::log(std::cos(psi)));
      return std::abs(ggxKernel(psi, alpha) / energy - fit);
    });
    EXPECT_NEAR(weight, 1, 1e-5);
    EXPECT_LT(difference, limit) << roughness;
  }
}

TEST(GgxLobes, ConstantSkyStaysConstant) {
  EnvironmentMap map = makeSky(128, 64, [](const Vec3&) { return Rgb(3, 2, 1); });
  Diagnostics diagnostics;
  const EnvironmentEvaluator evaluator(bakeEnvironment(map, {}, diagnostics, nullptr));
  for (float roughness : {0.0f, 0.2f, 0.6f, 1.0f})
    EXPECT_NEAR(evaluator.ggxRadiance(Vec3(0.6f, 0.8f, 0), roughness).x, 3, 2e-3) << roughness;
}

}  // namespace
}  // namespace lightwell::transport
