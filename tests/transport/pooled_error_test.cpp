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

/// Uniform in [0, 1).
double uniform(uint64_t trial, uint64_t what, uint64_t number) { return double(mixBits(combineKeys(combineKeys(trial, what), number))) * 0x1p-32; }
double normal(uint64_t trial, uint64_t what, uint64_t number) {
  return std::sqrt(-2 * std::log(1 - uniform(trial, what, 2 * number))) * std::cos(2 * double(kPi) * uniform(trial, what, 2 * number + 1));
}

/// Most texels are hardly off, few by a lot: log-normal errors of this `skew`. The references scatter by the share `noise`. At least the share `held` of the intervals holds.
void expectIntervalsToHold(double skew, double noise, double held) {
  constexpr size_t kAll = 20000, kSample = 500;
  constexpr int kTrials = 400;
  std::vector<std::vector<Rgb>> exact(3, std::vector<Rgb>(kAll));
  std::vector<Rgb> candidate(kAll);
  for (size_t t = 0; t < kAll; ++t) {
    const double truth = 0.1 + 2 * uniform(1, 0, t), off = 0.02 * std::exp(skew * normal(1, 1, t)) * (uniform(1, 2, t) < 0.6 ? 1 : -1);
    for (auto& map : exact) map[t] = Rgb(float(truth));
    candidate[t] = Rgb(float(truth * (1 + off)));
  }
  const PooledError all = compareWithReferences(exact, candidate);
  int relrmse = 0, texrel = 0, bias = 0, maximum = 0;
  for (uint64_t trial = 2; trial < 2 + kTrials; ++trial) {
    std::vector<std::vector<Rgb>> references(4, std::vector<Rgb>(kSample)), truth(3, std::vector<Rgb>(kSample));
    std::vector<Rgb> sample(kSample);
    for (size_t i = 0; i < kSample; ++i) {
      const auto t = size_t(uniform(trial, 9, i) * kAll);
      sample[i] = candidate[t];
      for (auto& map : truth) map[i] = exact[0][t];
      for (size_t k = 0; k < references.size(); ++k) references[k][i] = exact[0][t] * float(std::max(0.0, 1 + noise * normal(trial, 10 + k, i)));
    }
    const Retrace retrace = [&](std::span<const uint32_t> texels) {
      std::vector<std::vector<Rgb>> better(4);
      for (size_t k = 0; k < better.size(); ++k)
        for (const uint32_t i : texels) better[k].push_back(truth[0][i] * float(1 + noise / std::sqrt(double(kRetracedPaths)) * normal(trial, 20 + k, i)));
      return better;
    };
    const PooledError measured = compareWithReferences(references, sample, {}, retrace);
    const auto holds = [](const Interval& interval, double value) { return interval.low <= value && value <= interval.high; };
    relrmse += holds(measured.relrmse_95, all.relrmse);
    texrel += holds(measured.texrel_95, all.texrel);
    bias += holds(measured.bias_95, all.bias);
    maximum += holds(measured.maximum_95, compareWithReferences(truth, sample).maximum);
    EXPECT_LT(measured.relrmse_95.high, 10 * all.relrmse) << "an interval that says nothing holds everything";
  }
  std::printf("held of %d: relrmse %d, texrel %d, bias %d, maximum %d\n", kTrials, relrmse, texrel, bias, maximum);
  for (const int of_figure : {relrmse, texrel, bias, maximum}) EXPECT_GE(of_figure, int(held * kTrials));
}

TEST(PooledError, IntervalsOfASampleHoldWhatIsTrueOfAll) {
  expectIntervalsToHold(0.8, 0.2, 0.92);
  // One texel in a thousand has most of the error: no sample of 500 knows it well, but intervals know that they are skewed.
  expectIntervalsToHold(1.0, 0.05, 0.82);
}

TEST(PooledError, TexelsCountByTheirWeight) {
  const std::vector<Rgb> truth{Rgb(1.0f), Rgb(3.0f)}, candidate{Rgb(1.5f), Rgb(3.0f)}, repeated_truth{Rgb(1.0f), Rgb(3.0f), Rgb(3.0f), Rgb(3.0f)},
      repeated{Rgb(1.5f), Rgb(3.0f), Rgb(3.0f), Rgb(3.0f)};
  const std::vector<float> weight{2.0f, 6.0f};
  const PooledError weighted = compareWithReferences(std::vector(3, truth), candidate, weight), counted = compareWithReferences(std::vector(3, repeated_truth), repeated);
  EXPECT_NEAR(weighted.relrmse, counted.relrmse, 1e-9);
  EXPECT_NEAR(weighted.texrel, counted.texrel, 1e-9);
  EXPECT_NEAR(weighted.bias, counted.bias, 1e-9);
  EXPECT_NEAR(weighted.maximum, 0.5 / std::sqrt((1 + 3 * 9) / 4.0), 1e-6);
}

TEST(PooledError, NoiseOfTheCandidateDropsOutOfTwoHalves) {
  constexpr size_t kTexels = 50000;
  std::vector<std::vector<Rgb>> references(3, std::vector<Rgb>(kTexels));
  std::vector<Rgb> a(kTexels), b(kTexels);
  for (size_t t = 0; t < kTexels; ++t) {
    const double truth = 1 + uniform(1, 0, t), off = t % 2 ? 1.05 : 0.95;
    for (size_t k = 0; k < 3; ++k) references[k][t] = Rgb(float(truth * (1 + 0.1 * normal(1, k + 1, t))));
    a[t] = Rgb(float(truth * off * (1 + 0.3 * normal(1, 8, t))));
    b[t] = Rgb(float(truth * off * (1 + 0.3 * normal(1, 9, t))));
  }
  EXPECT_NEAR(compareWithReferences(references, {a, b}).relrmse, 0.05, 0.01);
  EXPECT_GT(compareWithReferences(references, a).relrmse, 0.25);
}

TEST(PooledError, TheMedianOfLightsHasAnIntervalOfTheirOrder) {
  int held = 0;
  for (uint64_t trial = 0; trial < 2000; ++trial) {
    std::vector<PooledError> errors(16);
    for (size_t i = 0; i < errors.size(); ++i) errors[i].relrmse = std::exp(normal(trial, 3, i));  // median 1
    const PooledError median = medianError(errors);
    held += median.relrmse_95.low <= 1 && 1 <= median.relrmse_95.high;
    EXPECT_LT(median.relrmse_95.high, 10);
  }
  EXPECT_GE(held, int(0.95 * 2000));
  EXPECT_EQ(medianError(std::vector<PooledError>(5)).relrmse_95.high, 0) << "five lights are too few to know";
}

TEST(PooledError, NothingLitIsInfinitelyWrong) {
  const std::vector<std::vector<Rgb>> references(3, std::vector<Rgb>(2, Rgb(0.0f)));
  EXPECT_TRUE(std::isinf(compareWithReferences(references, std::vector<Rgb>(2, Rgb(1.0f))).relrmse));
  EXPECT_THROW(compareWithReferences(std::span(references).first(2), std::vector<Rgb>(2)), std::logic_error);
}

}  // namespace
}  // namespace lightwell::transport
