// The random numbers that every estimator rests on.
#include "precompute/core/random.h"

#include <gtest/gtest.h>

#include <set>
#include <vector>

namespace lightwell {
namespace {

/// Pearson's statistic against `expected` counts; about normal with the returned z-score for many cells.
double chiSquareZ(const std::vector<double>& observed, const std::vector<double>& expected) {
  double chi2 = 0;
  for (size_t i = 0; i < observed.size(); ++i) chi2 += (observed[i] - expected[i]) * (observed[i] - expected[i]) / expected[i];
  const double freedom = double(observed.size() - 1);
  return (chi2 - freedom) / std::sqrt(2 * freedom);
}

/// Independent points: every one from another owner, so that the statistic is that of pure chance.
Vec2 independentPoint(uint32_t i) { return Sampler(7, i).get2D(3, 5); }

TEST(Sampler, EveryPrefixOfPowerOfTwoIsANet) {
  for (const uint64_t owner : {0ull, 1ull, 977ull, ~0ull})
    for (uint32_t dimension = 0; dimension < 4; ++dimension)
      for (int bits = 0; bits <= 10; ++bits) {
        const Sampler sampler(42, owner);
        for (int bits_x = 0; bits_x <= bits; ++bits_x) {  // elementary intervals of 2^-bits_x by 2^-(bits - bits_x)
          std::set<std::pair<int, int>> cells;
          for (uint32_t i = 0; i < (1u << bits); ++i) {
            const Vec2 p = sampler.get2D(i, dimension);
            cells.insert({int(std::ldexp(p.x, bits_x)), int(std::ldexp(p.y, bits - bits_x))});
          }
          ASSERT_EQ(cells.size(), size_t(1) << bits) << "owner " << owner << " dimension " << dimension << " " << bits_x << "/" << bits;
        }
      }
}

TEST(Sampler, OneDimensionIsStratified) {
  const Sampler sampler(1, 2);
  for (int bits = 0; bits <= 12; ++bits) {
    std::set<int> cells;
    for (uint32_t i = 0; i < (1u << bits); ++i) cells.insert(int(std::ldexp(sampler.get1D(i, 3), bits)));
    ASSERT_EQ(cells.size(), size_t(1) << bits);
  }
}

TEST(Sampler, StaysBelowOne) {
  for (uint32_t i = 0; i < 100000; ++i) {
    const Vec2 p = Sampler(i, i * 31).get2D(i, i % 7);
    ASSERT_TRUE(p.x >= 0 && p.x < 1 && p.y >= 0 && p.y < 1);
  }
}

TEST(Sampler, OwnersDimensionsAndSeedsAreUncorrelated) {
  constexpr uint32_t kCount = 1 << 14;
  const auto correlation = [&](auto first, auto second) {
    double sum = 0;
    for (uint32_t i = 0; i < kCount; ++i) sum += (first(i) - 0.5) * (second(i) - 0.5) * 12;
    return sum / kCount * std::sqrt(double(kCount));  // a z-score for independent points
  };
  const Sampler a(1, 10), b(1, 11), c(2, 10);
  for (uint32_t d = 0; d < 8; ++d) {
    const auto x = [&](uint32_t i) { return a.get2D(i, d).x; };
    EXPECT_LT(std::abs(correlation(x, [&](uint32_t i) { return a.get2D(i, d + 1).x; })), 4.5) << d;
    EXPECT_LT(std::abs(correlation(x, [&](uint32_t i) { return b.get2D(i, d).x; })), 4.5) << d;
    EXPECT_LT(std::abs(correlation([&](uint32_t i) { return a.get2D(i, d).y; }, [&](uint32_t i) { return c.get2D(i, d).y; })), 4.5) << d;
    EXPECT_LT(std::abs(correlation(x, [&](uint32_t i) { return a.get1D(i, d); })), 4.5) << d;
  }
}

TEST(Sampler, FirstPointsOfOwnersAreUniform) {
  constexpr int kGrid = 16, kCount = 1 << 18;
  std::vector<double> observed(kGrid * kGrid), expected(kGrid * kGrid, double(kCount) / (kGrid * kGrid));
  for (int i = 0; i < kCount; ++i) {
    const Vec2 p = independentPoint(i);
    ++observed[int(p.y * kGrid) * kGrid + int(p.x * kGrid)];
  }
  EXPECT_LT(std::abs(chiSquareZ(observed, expected)), 4.5);
}

TEST(CosineHemisphere, DensityIsCosineOverPi) {
  // Cells of equal measure under cos/π: equal steps of r² (the projected disk) and of the azimuth.
  constexpr int kRings = 16, kSectors = 24, kCount = 1 << 19;
  std::vector<double> observed(kRings * kSectors), expected(kRings * kSectors, double(kCount) / (kRings * kSectors));
  double mean_cosine = 0;
  for (int i = 0; i < kCount; ++i) {
    const Vec3 d = sampleCosineHemisphere(independentPoint(i));
    ASSERT_NEAR(d.length(), 1.0f, 1e-5f);
    ASSERT_GE(d.z, 0.0f);
    const float r2 = std::min(d.x * d.x + d.y * d.y, 0.999999f), sector = (std::atan2(d.y, d.x) + kPi) / (2 * kPi) * kSectors;
    ++observed[int(r2 * kRings) * kSectors + std::min(int(sector), kSectors - 1)];
    mean_cosine += d.z;
  }
  EXPECT_LT(std::abs(chiSquareZ(observed, expected)), 4.5);
  EXPECT_NEAR(mean_cosine / kCount, 2.0 / 3.0, 2e-3);
}

TEST(CosineHemisphere, ConcentricMapHasAnInverse) {
  for (int i = 0; i < 20000; ++i) {
    const Vec2 u = independentPoint(i);
    const Vec3 d = sampleCosineHemisphere(u);
    // Inverse of Shirley and Chiu's map: the radius is the greater coordinate, the angle measures the other one.
    const float radius = std::hypot(d.x, d.y);
    float a, b;
    if (std::abs(d.x) >= std::abs(d.y)) {
      a = std::copysign(radius, d.x);
      b = a * std::atan(d.y / d.x) / (kPi / 4);
    } else {
      b = std::copysign(radius, d.y);
      a = b * std::atan(d.x / d.y) / (kPi / 4);
    }
    ASSERT_NEAR((a + 1) / 2, u.x, 1e-4f);
    ASSERT_NEAR((b + 1) / 2, u.y, 1e-4f);
  }
}

TEST(SampleTriangle, IsUniformAndInside) {
  // The unit right triangle in a grid: whole cells below the diagonal, half cells on it.
  constexpr int kGrid = 12, kCount = 1 << 19;
  std::vector<double> observed, expected;
  std::vector<int> cell(kGrid * kGrid, -1);
  for (int j = 0; j < kGrid; ++j)
    for (int i = 0; i + j < kGrid; ++i) {
      cell[j * kGrid + i] = int(expected.size());
      expected.push_back((i + j == kGrid - 1 ? 1.0 : 2.0) * kCount / (kGrid * kGrid));
    }
  observed.resize(expected.size());
  for (int i = 0; i < kCount; ++i) {
    const Vec2 b = sampleTriangle(independentPoint(i));
    ASSERT_TRUE(b.x >= 0 && b.y >= 0 && b.x + b.y <= 1 + 1e-6f);
    const int x = std::min(int(b.x * kGrid), kGrid - 1), y = std::min(int(b.y * kGrid), kGrid - 1 - x);
    ++observed[cell[y * kGrid + x]];
  }
  EXPECT_LT(std::abs(chiSquareZ(observed, expected)), 4.5);
}

TEST(OrthonormalBasis, IsRightHandedForEveryNormal) {
  for (int i = 0; i < 20000; ++i) {
    const Vec2 u = independentPoint(i);
    const float z = i == 0 ? 1.0f : i == 1 ? -1.0f : 2 * u.x - 1, r = std::sqrt(std::max(0.0f, 1 - z * z));
    const Vec3 n(r * std::cos(2 * kPi * u.y), r * std::sin(2 * kPi * u.y), z);
    Vec3 t, b;
    orthonormalBasis(n, t, b);
    ASSERT_NEAR(t.length(), 1, 1e-5f);
    ASSERT_NEAR(t.dot(n), 0, 1e-5f);
    ASSERT_LT((t.cross(b) - n).length(), 1e-5f);
  }
}

}  // namespace
}  // namespace lightwell
