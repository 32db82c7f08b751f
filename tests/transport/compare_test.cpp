#include "precompute/transport/compare.h"

#include <gtest/gtest.h>

#include <limits>

#include "precompute/core/error.h"
#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

ImageRgba map(std::initializer_list<float> values, int width) {
  ImageRgba image{width, int(values.size()) / width, {}};
  for (const float v : values) image.pixels.push_back({v, v, v, 1});
  return image;
}

TEST(CompareMaps, FollowsTheDefinitions) {
  const ImageRgba r = map({1, 2, 3, 4}, 2), c = map({1.1f, 2, 2.7f, 4}, 2);
  const MapError error = compareMaps(r, c);
  EXPECT_EQ(error.texels, 4u);
  EXPECT_EQ(error.missing, 0u);
  EXPECT_NEAR(error.relrmse, std::sqrt((0.01 + 0.09) / 30), 1e-6);
  const double spread = 1.96 * std::sqrt((0.01 * 0.01 + 0.09 * 0.09 - 0.1 * 0.1 / 4) * 4 / 3);  // of the sum of squares over four texels
  EXPECT_NEAR(error.relrmse_high, std::sqrt((0.1 + spread) / 30), 1e-6);
  EXPECT_NEAR(error.relrmse_low, -std::sqrt((spread - 0.1) / 30), 1e-6);
  EXPECT_NEAR(error.texrel, std::sqrt((0.01 / (1.25 * 1.25) + 0.09 / (3.25 * 3.25)) / 4), 1e-6);
  EXPECT_NEAR(error.bias, 9.8 / 10 - 1, 1e-6);
  EXPECT_NEAR(error.max, 0.3 / std::sqrt(30.0 / 4), 1e-6);
  EXPECT_NEAR(error.p99, (0.1 + 0.97 * 0.2) / std::sqrt(30.0 / 4), 1e-6);  // linear between the two greatest
}

TEST(CompareMaps, AnExactCopyHasNoError) {
  const MapError error = compareMaps(map({1, 2}, 2), map({1, 2}, 2));
  EXPECT_EQ(error.relrmse, 0);
  EXPECT_EQ(error.texrel, 0);
  EXPECT_EQ(error.bias, 0);
}

TEST(CompareMaps, LeavesOutUncoveredAndUnlitTexels) {
  ImageRgba r = map({1, 5, 1, 0, 1, 1e-6f}, 3), c = map({1, 9, 9, 7, 1, 7}, 3);
  r.pixels[1][3] = 0;  // not covered by the reference
  c.pixels[2][3] = 0;  // nor this one by the candidate; texels 3 and 5 are unlit
  const MapError error = compareMaps(r, c);
  EXPECT_EQ(error.texels, 2u);
  EXPECT_EQ(error.missing, 1u);
  EXPECT_EQ(error.relrmse, 0);
  EXPECT_EQ(error.relrmse_high, 0) << "of the same texels";
}

TEST(CompareMaps, CountsWhatIsNotANumberAndWhatIsNegative) {
  ImageRgba c = map({1, -2, 3, 4}, 2);
  c.pixels[2][1] = std::numeric_limits<float>::quiet_NaN();
  ImageRgba r = map({1, 2, 3, 4}, 2);
  r.pixels[3][0] = std::numeric_limits<float>::infinity();  // Cycles leaves such texels: taken as uncovered
  const MapError error = compareMaps(r, c);
  EXPECT_EQ(error.nonfinite, 1u);
  EXPECT_EQ(error.negative, 1u);
  EXPECT_EQ(error.texels, 2u);
  EXPECT_TRUE(std::isfinite(error.relrmse));
}

TEST(CompareMaps, TwoNoisyReferencesDropTheirOwnNoise) {
  constexpr int kSize = 200;
  ImageRgba a{kSize, kSize, {}}, b = a, c = a;
  const Sampler sampler(1, 2);
  for (uint32_t i = 0; i < kSize * kSize; ++i) {
    const auto noisy = [&](uint32_t owner, float amplitude) {
      std::array<float, 4> p{0, 0, 0, 1};
      for (uint32_t k = 0; k < 3; ++k) p[k] = 1 + amplitude * (2 * Sampler(owner, i).get1D(0, k) - 1);
      return p;
    };
    a.pixels.push_back(noisy(1, 0.15f));
    b.pixels.push_back(noisy(2, 0.15f));
    c.pixels.push_back(noisy(3, 0.1f));
  }
  const double own = 0.1 / std::sqrt(3.0), reference = 0.15 / std::sqrt(3.0);
  const MapError of_two = compareMaps(a, c, &b);
  EXPECT_NEAR(of_two.relrmse, own, 0.15 * own);
  EXPECT_LE(of_two.relrmse_low, own);
  EXPECT_GE(of_two.relrmse_high, own);
  EXPECT_LT(of_two.relrmse_high - of_two.relrmse_low, 0.1 * own);
  EXPECT_NEAR(compareMaps(a, c, &b).texrel, own / 1.1, 0.25 * own);
  EXPECT_NEAR(compareMaps(a, c).relrmse, std::hypot(own, reference) / std::sqrt(1 + reference * reference), 0.01);
}

TEST(CompareMaps, NothingInCommonIsInfinitelyWrong) {
  ImageRgba r = map({1, 1}, 2), c = map({1, 1}, 2);
  c.pixels[0][3] = c.pixels[1][3] = 0;
  const MapError error = compareMaps(r, c);
  EXPECT_EQ(error.texels, 0u);
  EXPECT_TRUE(std::isinf(error.relrmse));
  EXPECT_THROW(compareMaps(map({1, 1}, 2), map({1, 1}, 1)), UsageError);
}

}  // namespace
}  // namespace lightwell::transport
