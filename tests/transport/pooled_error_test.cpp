// Errors against noisy references: exact where there is no noise, and where there is, about what the noise-free truth would have said.
#include "precompute/transport/pooled_error.h"

#include <gtest/gtest.h>

#include <cmath>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

TEST(PooledError, IsExactWithoutNoise) {
  const std::vector<Rgb> truth{Rgb(1.0f), Rgb(3.0f)};
  const std::vector<std::vector<Rgb>> references(4, truth);
  const std::vector<Rgb> candidate{Rgb(1.5f), Rgb(3.0f)};
  const PooledError error = compareWithReferences(references, candidate);
  EXPECT_EQ(error.texels, 2u);
  EXPECT_NEAR(error.relrmse, std::sqrt(0.25 / 2) / std::sqrt(5.0), 1e-6);
  EXPECT_NEAR(error.texrel, std::sqrt(0.5 * (0.5 / 1.2) * (0.5 / 1.2)), 1e-6);
  EXPECT_NEAR(error.bias, 4.5 / 4 - 1, 1e-6);
}

TEST(PooledError, NoiseOfTheReferencesHardlyMatters) {
  // Every texel's candidate is 10 % too bright or too dark; each reference is off by up to half its value.
  constexpr size_t kTexels = 20000;
  std::vector<std::vector<Rgb>> references(4, std::vector<Rgb>(kTexels));
  std::vector<Rgb> candidate(kTexels);
  for (size_t t = 0; t < kTexels; ++t) {
    const float truth = 0.2f + float(t % 10);
    candidate[t] = Rgb(truth * (t % 2 ? 1.1f : 0.9f));
    for (uint64_t k = 0; k < references.size(); ++k) {
      const float u = float(mixBits(combineKeys(k, t)) >> 8) * 0x1p-24f;
      references[k][t] = Rgb(truth * (0.5f + u));
    }
  }
  const PooledError error = compareWithReferences(references, candidate);
  EXPECT_NEAR(error.relrmse, 0.1, 0.01);
  double expected = 0;
  for (size_t t = 0; t < kTexels; ++t) {
    const double truth = 0.2 + double(t % 10);
    expected += std::pow(0.1 * truth / (truth + 0.1 * 4.7), 2) / kTexels;
  }
  EXPECT_NEAR(error.texrel / std::sqrt(expected), 1, 0.15);
  EXPECT_NEAR(error.bias, 0, 0.02);
}

TEST(PooledError, NothingLitIsInfinitelyWrong) {
  const std::vector<std::vector<Rgb>> references(3, std::vector<Rgb>(2, Rgb(0.0f)));
  EXPECT_TRUE(std::isinf(compareWithReferences(references, std::vector<Rgb>(2, Rgb(1.0f))).relrmse));
  EXPECT_THROW(compareWithReferences(std::span(references).first(2), std::vector<Rgb>(2)), std::logic_error);
}

}  // namespace
}  // namespace lightwell::transport
