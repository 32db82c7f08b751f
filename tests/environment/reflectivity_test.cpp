#include "precompute/transport/environment/reflectivity.h"

#include <gtest/gtest.h>

namespace lightwell::transport {
namespace {

constexpr double kPiD = std::numbers::pi;
constexpr Reflectivity kModels[] = {Reflectivity::single, Reflectivity::paper, Reflectivity::vmf, Reflectivity::spread};

/// An evenly lit cap about +z.
CellShape capOf(double radius) {
  const double depth = 2 * std::pow(std::sin(radius / 2), 2), c = 1 - depth;
  CellShape cap{Vec3(0, 0, 1), float(2 * kPiD * depth), float(depth / 2), {}};
  const double variance = 0.5 * (1 - (1 + c + c * c) / 3);  // E[x²] of a cap: (1 − E[cos²]) / 2
  cap.covariance = {float(variance), 0, float(variance)};
  return cap;
}

/// Mean of max(0, cos ψ)^n over the cap by quadrature; `psi` from its centre.
double quadrature(double radius, double psi, double n) {
  const int rings = 400, sectors = 400;
  double sum = 0, area = 0;
  for (int i = 0; i < rings; ++i) {
    const double r = radius * (i + 0.5) / rings, weight = std::sin(r);
    for (int j = 0; j < sectors; ++j) {
      const double a = (j + 0.5) / sectors * 2 * kPiD;
      const double cosine = std::cos(r) * std::cos(psi) + std::sin(r) * std::sin(psi) * std::cos(a);
      sum += weight * (cosine > 0 ? std::pow(cosine, n) : 0);
      area += weight;
    }
  }
  return sum / area;
}
Vec3 tilted(double psi) { return {float(std::sin(psi)), 0, float(std::cos(psi))}; }

TEST(Reflectivity, PaperIsExactAtTheCentreOfACapWithoutCancellation) {
  for (double n : {1.0, 10.0, 100.0, 1e3, 1e4, 1e5})
    for (double r : {1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.5, 3.14159}) {
      const long double depth = 2 * powl(sinl(r / 2), 2), missed = depth < 1 ? -expm1l((n + 1) * log1pl(-depth)) : 1;
      const double exact = double(missed / ((n + 1) * depth));
      EXPECT_NEAR(averageCosinePower(Reflectivity::paper, capOf(r), Vec3(0, 0, 1), float(n)) / exact, 1, 2e-5) << n << " " << r;
    }
}

TEST(Reflectivity, PaperMatchesItsFigure5) {
  // "The error is larger than 100 %" beyond r = 0.6 for n = 10 and beyond r = 0.18 for n = 100.
  EXPECT_NEAR(1 / averageCosinePower(Reflectivity::paper, capOf(0.6), Vec3(0, 0, 1), 10), 2, 0.3);
  EXPECT_NEAR(1 / averageCosinePower(Reflectivity::paper, capOf(0.18), Vec3(0, 0, 1), 100), 2, 0.3);
}

TEST(Reflectivity, PaperBlendsIntoTheSingleSampleAtTheRim) {
  const CellShape cap = capOf(0.3);
  EXPECT_NEAR(averageCosinePower(Reflectivity::paper, cap, tilted(0.3001), 50), std::pow(std::cos(0.3001), 50), 1e-4);
  EXPECT_NEAR(averageCosinePower(Reflectivity::paper, cap, tilted(0.2999), 50), std::pow(std::cos(0.2999), 50), 1e-3);
}

TEST(Reflectivity, FiniteAndBoundedForEveryCellAndLobe) {
  for (float n : {1.0f, 3.0f, 100.0f, 1e5f})
    for (double r : {1e-4, 1e-2, 1.0, 3.1415926})
      for (double psi : {0.0, 1e-4, 0.5, 1.5707963, 3.0, 3.1415926})
        for (Reflectivity model : kModels) {
          for (const Vec3& axis : {tilted(psi), -tilted(psi)}) {
            const float value = averageCosinePower(model, capOf(r), axis, n), diffuse = averageCosine(model, capOf(r), axis);
            EXPECT_TRUE(value >= 0 && value <= 1.0001f) << int(model) << " " << n << " " << r << " " << psi << " " << value;
            EXPECT_TRUE(diffuse >= 0 && diffuse <= 1.0001f) << int(model) << " " << r << " " << psi << " " << diffuse;
          }
        }
}

TEST(Reflectivity, PointCellsGiveTheLobeItself) {
  CellShape point{Vec3(0, 0, 1), 1e-9f, 0, {0, 0, 0}};
  for (float n : {1.0f, 10.0f, 1e3f, 1e5f})
    for (double psi : {0.0, 1e-3, 3e-3, 0.02, 0.4}) {
      const double exact = std::exp(n * std::log(std::cos(psi)));
      for (Reflectivity model : {Reflectivity::single, Reflectivity::paper, Reflectivity::spread})
        EXPECT_NEAR(averageCosinePower(model, point, tilted(psi), n), exact, 1e-3 * exact + 1e-6) << int(model) << " " << n << " " << psi;
    }
}

TEST(Reflectivity, SpreadAgreesWithQuadratureForCellsNarrowerThanTheLobe) {
  for (const auto& [n, r] :
       {std::pair{1.0, 0.3}, std::pair{4.0, 0.2}, std::pair{10.0, 0.2}, std::pair{100.0, 0.07}, std::pair{1000.0, 0.02}})
    for (double share : {0.0, 0.5, 1.0, 2.0}) {
      const double psi = share / std::sqrt(n + 2), exact = quadrature(r, psi, n);
      EXPECT_NEAR(averageCosinePower(Reflectivity::spread, capOf(r), tilted(psi), float(n)) / exact, 1, 0.01) << n << " " << psi;
    }
}

TEST(Reflectivity, SpreadKeepsTheEnergyOfNarrowLobes) {
  // ∫ over all mirror directions of the average is that of the lobe, 2π / (n + 1), whatever the cell.
  for (double r : {0.01, 0.1, 0.3})
    for (float n : {100.0f, 1000.0f}) {
      double sum = 0;
      const int steps = 20000;
      for (int i = 0; i < steps; ++i) {
        const double psi = (i + 0.5) / steps * kPiD / 2;
        sum += averageCosinePower(Reflectivity::spread, capOf(r), tilted(psi), n) * 2 * kPiD * std::sin(psi) * kPiD / 2 / steps;
      }
      EXPECT_NEAR(sum * (n + 1) / (2 * kPiD), 1, 0.06) << r << " " << n;
    }
}

TEST(Reflectivity, DiffuseAcrossTheHorizonIsTheMeanOfWhatIsAboveIt) {
  for (double psi : {0.0, 0.6, 1.4, 1.5707963, 1.7, 2.5})
    EXPECT_NEAR(averageCosine(Reflectivity::spread, capOf(0.3), tilted(psi)), quadrature(0.3, psi, 1), 0.006) << psi;
}

}  // namespace
}  // namespace lightwell::transport
