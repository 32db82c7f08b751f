// Evaluation on the CPU: physics of the lights, averages, and the weighted sums against a plain double-precision evaluation.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/runtime/support.h"
#include "tests/runtime/synthetic_prm.h"

namespace lightwell::test {
namespace {

constexpr double kPi = 3.14159265358979;

lw_light pointLight(float x, float y, float z, float candela) {
  lw_light light{};
  light.type = LW_LIGHT_POINT;
  light.position_m[0] = x, light.position_m[1] = y, light.position_m[2] = z;
  light.direction[1] = -1;
  light.outer_cone_angle_rad = 0.7f;
  for (float& i : light.intensity_rgb) i = candela;
  return light;
}

class PrmEvaluation : public testing::TestWithParam<Layout> {
 protected:
  PrmEvaluation() {
    SyntheticOptions options;
    options.layout = GetParam();
    synthetic = makeSyntheticPrm(options);
    container = openMemory(synthetic.container);
    prm = loadPrm(container.get());
  }
  std::vector<float> evaluate(const std::vector<float>& irradiance, const lw_prm_options* options) {
    std::vector<uint32_t> scratch(lw_prm_scratch_bytes(prm.get()) / 4 + 1);
    std::vector<float> atlas(synthetic.source.size() * 4, -1.0f);
    EXPECT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), options, scratch.data(), scratch.size() * 4, atlas.data()), LW_OK);
    return atlas;
  }
  SyntheticPrm synthetic;
  Container container;
  Prm prm{nullptr, lw_prm_release};
};

TEST_P(PrmEvaluation, AgreesWithThePlainSum) {
  const auto irradiance = randomIrradiance(synthetic.options.clusters, 5);
  const auto expected = synthetic.evaluate(irradiance);
  const auto atlas = evaluate(irradiance, nullptr);
  EXPECT_LT(relrmse(atlas, expected), 1e-6);
  for (size_t i = 0; i < synthetic.source.size(); ++i) EXPECT_EQ(atlas[i * 4 + 3], float(expected[i * 4 + 3]));
}

/// For measuring: buried texels have their own value, gutters none.
TEST_P(PrmEvaluation, ShowsEachTexelsOwnValueWhenNotFilled) {
  const auto irradiance = randomIrradiance(synthetic.options.clusters, 5);
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  options.fill = 0;
  const auto expected = synthetic.evaluate(irradiance, LW_EMITTERS_INDIRECT, 0, true, false);
  const auto atlas = evaluate(irradiance, &options);
  EXPECT_LT(relrmse(atlas, expected), 1e-6);
  EXPECT_GT(relrmse(atlas, synthetic.evaluate(irradiance)), 0.1);
  for (size_t i = 0; i < synthetic.source.size(); ++i) EXPECT_EQ(atlas[i * 4 + 3], float(expected[i * 4 + 3]));
}

TEST_P(PrmEvaluation, AddsEmittersAsAsked) {
  const std::vector<float> dark(size_t(synthetic.options.clusters) * 3, 0.0f);
  for (const uint32_t emitters : {0u, 1u, 2u, 3u}) {
    lw_prm_options options = LW_PRM_OPTIONS_INIT;
    options.emitters = emitters;
    const auto expected = synthetic.evaluate(dark, emitters);
    const auto atlas = evaluate(dark, &options);
    for (size_t i = 0; i < atlas.size(); ++i) ASSERT_NEAR(atlas[i], expected[i], 1e-5) << emitters;
  }
}

TEST_P(PrmEvaluation, RejectsBadNumbers) {
  std::vector<float> irradiance(size_t(synthetic.options.clusters) * 3, 1.0f), atlas(synthetic.source.size() * 4);
  std::vector<uint32_t> scratch(lw_prm_scratch_bytes(prm.get()) / 4 + 1);
  for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    irradiance[7] = bad;
    EXPECT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), nullptr, scratch.data(), scratch.size() * 4, atlas.data()),
              LW_INVALID_ARGUMENT);
  }
  irradiance[7] = 1;
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  options.emitters = 16;
  EXPECT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), &options, scratch.data(), scratch.size() * 4, atlas.data()), LW_INVALID_ARGUMENT);
  options.emitters = 0;
  options.fill = 2;
  EXPECT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), &options, scratch.data(), scratch.size() * 4, atlas.data()), LW_INVALID_ARGUMENT);
  if (lw_prm_scratch_bytes(prm.get())) {
    EXPECT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), nullptr, scratch.data(), 4, atlas.data()), LW_INVALID_ARGUMENT);
  }
}

/// The largest irradiances that are allowed end in finite values.
TEST_P(PrmEvaluation, StaysFinite) {
  const std::vector<float> blinding(size_t(synthetic.options.clusters) * 3, std::numeric_limits<float>::max());
  for (const float v : evaluate(blinding, nullptr)) ASSERT_TRUE(std::isfinite(v) && v >= 0);
}

INSTANTIATE_TEST_SUITE_P(Layouts, PrmEvaluation,
                         testing::Values(Layout::panes_rgb9e5, Layout::panes_half, Layout::local_bases));

TEST(PrmLocalBases, AreSummedAtTheirLimits) {
  for (const SyntheticOptions& options : extremeLocalBases()) {
    const SyntheticPrm synthetic = makeSyntheticPrm(options);
    const Container container = openMemory(synthetic.container);
    const Prm prm = loadPrm(container.get());
    std::vector<float> irradiance(size_t(options.clusters) * 3), scratch(lw_prm_scratch_bytes(prm.get()) / sizeof(float));
    for (size_t i = 0; i < irradiance.size(); ++i) irradiance[i] = 0.5f + float(i);
    std::vector<float> atlas(synthetic.source.size() * 4);
    ASSERT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), nullptr, scratch.data(), scratch.size() * sizeof(float), atlas.data()), LW_OK);
    EXPECT_LT(relrmse(atlas, synthetic.evaluate(irradiance)), 2e-6) << options.clusters << " clusters, " << options.blocks << " blocks";
  }
}

/// What sums may leave out stays below the tolerance, near it for a large one, and is nothing for zero.
TEST(PrmLocalBases, LeaveOutNoMoreThanTheTolerance) {
  SyntheticOptions shape;
  shape.layout = Layout::local_bases;
  shape.clusters = 200, shape.blocks = 20;
  const SyntheticPrm synthetic = makeSyntheticPrm(shape);
  const Container container = openMemory(synthetic.container);
  const Prm prm = loadPrm(container.get());
  const auto irradiance = randomIrradiance(shape.clusters, 3);
  std::vector<float> scratch(lw_prm_scratch_bytes(prm.get()) / sizeof(float)), exact(synthetic.source.size() * 4), atlas(exact.size());
  lw_prm_options options = LW_PRM_OPTIONS_INIT;
  options.emitters = LW_EMITTERS_OFF;
  options.tolerance = 0;
  ASSERT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), &options, scratch.data(), scratch.size() * sizeof(float), exact.data()), LW_OK);
  EXPECT_LT(relrmse(exact, synthetic.evaluate(irradiance, LW_EMITTERS_OFF)), 2e-6);
  double last = 0;
  for (const float tolerance : {1e-3f, 1e-2f, 0.1f}) {
    options.tolerance = tolerance;
    ASSERT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), &options, scratch.data(), scratch.size() * sizeof(float), atlas.data()), LW_OK);
    const double error = relrmse(atlas, exact);
    EXPECT_LT(error, 2 * tolerance);
    EXPECT_GT(error, last);
    last = error;
  }
  for (const float bad : {-0.1f, 1.1f, std::numeric_limits<float>::quiet_NaN()}) {
    options.tolerance = bad;
    EXPECT_EQ(lw_prm_evaluate(prm.get(), irradiance.data(), &options, scratch.data(), scratch.size() * sizeof(float), atlas.data()), LW_INVALID_ARGUMENT);
  }
}

class PrmPanes : public PrmEvaluation {};

TEST_P(PrmPanes, KeepsTheEnergyOfTheClustersLeftOut) {
  const auto irradiance = randomIrradiance(synthetic.options.clusters, 6);
  for (const uint32_t brightest : {1u, 5u, 20u, 39u, 40u, 1000u})
    for (const uint32_t keep : {0u, 1u}) {
      lw_prm_options options = LW_PRM_OPTIONS_INIT;
      options.brightest = brightest;
      options.keep_energy = keep;
      EXPECT_LT(relrmse(evaluate(irradiance, &options), synthetic.evaluate(irradiance, LW_EMITTERS_INDIRECT, brightest, keep)), 1e-5)
          << brightest << " " << keep;
    }
}

INSTANTIATE_TEST_SUITE_P(Layouts, PrmPanes, testing::Values(Layout::panes_rgb9e5, Layout::panes_half));

class PrmLights : public testing::Test {
 protected:
  PrmLights() {
    synthetic = makeSyntheticPrm({});
    container = openMemory(synthetic.container);
    prm = loadPrm(container.get());
    irradiance.resize(size_t(synthetic.entries()) * 3);
  }
  lw_result shine(const std::vector<lw_light>& lights, lw_visibility_fn visibility = nullptr, void* user = nullptr) {
    return lw_prm_entry_irradiance(prm.get(), lights.data(), uint32_t(lights.size()), visibility, user, irradiance.data());
  }
  double cosine(uint32_t entry, std::array<double, 3> to_light) const {
    double c = 0;
    for (int k = 0; k < 3; ++k) c += to_light[k] * synthetic.entry_normal[entry * 3 + k];
    return std::max(c, 0.0);
  }
  SyntheticPrm synthetic;
  Container container;
  Prm prm{nullptr, lw_prm_release};
  std::vector<float> irradiance;
};

TEST_F(PrmLights, PointLightFollowsTheInverseSquare) {
  for (const float range : {0.0f, 4.0f}) {
    lw_light light = pointLight(0.3f, 2.5f, -0.4f, 100);
    light.range_m = range;
    ASSERT_EQ(shine({light}), LW_OK);
    int lit = 0;
    for (uint32_t e = 0; e < synthetic.entries(); ++e) {
      std::array<double, 3> d;
      double square = 0;
      for (int k = 0; k < 3; ++k) d[k] = double(light.position_m[k]) - synthetic.entry_position[e * 3 + k], square += d[k] * d[k];
      for (double& v : d) v /= std::sqrt(square);
      const double window = range ? std::clamp(1 - std::pow(std::sqrt(square) / range, 4), 0.0, 1.0) : 1.0;
      const double expected = 100 * cosine(e, d) / square * window;
      ASSERT_NEAR(irradiance[e * 3], expected, 1e-4 * expected + 1e-5);
      lit += expected > 0;
    }
    EXPECT_GT(lit, 20);
  }
}

TEST_F(PrmLights, SpotHasASmoothEdgeAndDirectionalNeitherEdgeNorFalloff) {
  lw_light spot = pointLight(0, 3, 0, 50);
  spot.type = LW_LIGHT_SPOT;
  spot.direction[1] = -5;  // any length
  spot.inner_cone_angle_rad = 0.2f;
  spot.outer_cone_angle_rad = 0.6f;
  ASSERT_EQ(shine({spot}), LW_OK);
  int inside = 0, between = 0, outside = 0;
  for (uint32_t e = 0; e < synthetic.entries(); ++e) {
    std::array<double, 3> d;
    double square = 0;
    for (int k = 0; k < 3; ++k) d[k] = double(spot.position_m[k]) - synthetic.entry_position[e * 3 + k], square += d[k] * d[k];
    for (double& v : d) v /= std::sqrt(square);
    const double edge = std::clamp((d[1] - std::cos(0.6)) / (std::cos(0.2) - std::cos(0.6)), 0.0, 1.0);
    const double expected = 50 * cosine(e, d) / square * edge * edge;
    ASSERT_NEAR(irradiance[e * 3 + 1], expected, 1e-4 * expected + 1e-4);
    ++(edge == 0 ? outside : edge == 1 ? inside : between);
  }
  EXPECT_GT(inside, 0);
  EXPECT_GT(between, 5);
  EXPECT_GT(outside, 5);

  lw_light sun = pointLight(0, 0, 0, 100000);
  sun.type = LW_LIGHT_DIRECTIONAL;
  ASSERT_EQ(shine({sun}), LW_OK);
  for (uint32_t e = 0; e < synthetic.entries(); ++e) ASSERT_NEAR(irradiance[e * 3], 1e5 * cosine(e, {0, 1, 0}), 0.05);
}

TEST_F(PrmLights, SumsLightsAndAsksForShadowsInBatches) {
  const lw_light a = pointLight(0, 2, 0, 10), b = pointLight(1, 0, 2, 30);
  ASSERT_EQ(shine({a}), LW_OK);
  auto sum = irradiance;
  ASSERT_EQ(shine({b}), LW_OK);
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += irradiance[i];
  ASSERT_EQ(shine({a, b}), LW_OK);
  for (size_t i = 0; i < sum.size(); ++i) ASSERT_NEAR(irradiance[i], sum[i], 1e-5 * sum[i]);

  struct Seen {
    const SyntheticPrm* synthetic;
    uint32_t rays = 0;
  } seen{&synthetic};
  ASSERT_EQ(shine({a, b},
                  [](void* user, const lw_shadow_ray* rays, uint32_t count, float* visibility) {
                    auto& s = *static_cast<Seen*>(user);
                    ASSERT_LE(count, 256u);
                    for (uint32_t i = 0; i < count; ++i) {
                      ASSERT_EQ(rays[i].origin_m[1], s.synthetic->entry_position[rays[i].entry * 3 + 1]);
                      visibility[i] = rays[i].entry % 2 ? 0.25f : 0.0f;
                    }
                    s.rays += count;
                  },
                  &seen),
            LW_OK);
  for (size_t i = 0; i < sum.size(); ++i) ASSERT_NEAR(irradiance[i], i / 3 % 2 ? sum[i] / 4 : 0, 1e-5 * sum[i]);
  EXPECT_GT(seen.rays, 0u);
  EXPECT_LT(seen.rays, 2 * synthetic.entries());  // not asked where the light is behind
}

TEST_F(PrmLights, AveragesOverClusters) {
  ASSERT_EQ(shine({pointLight(0, 2, 0, 10)}), LW_OK);
  std::vector<float> cluster(size_t(synthetic.options.clusters) * 3);
  ASSERT_EQ(lw_prm_cluster_irradiance(prm.get(), irradiance.data(), cluster.data()), LW_OK);
  for (uint32_t c = 0; c < synthetic.options.clusters; ++c) {
    double mean = 0;
    for (uint32_t e = synthetic.cluster_first_entry[c]; e < synthetic.cluster_first_entry[c + 1]; ++e)
      mean += double(synthetic.entry_weight[e]) * irradiance[e * 3 + 2];
    ASSERT_NEAR(cluster[c * 3 + 2], mean, 1e-5 * mean + 1e-9);
  }
}

TEST_F(PrmLights, LightOnASurfaceStaysFinite) {
  lw_light light = pointLight(synthetic.entry_position[0], synthetic.entry_position[1], synthetic.entry_position[2], 1e20f);
  ASSERT_EQ(shine({light}), LW_OK);
  for (const float v : irradiance) ASSERT_TRUE(std::isfinite(v));
  for (int k = 0; k < 3; ++k) light.position_m[k] += 1e-6f * synthetic.entry_normal[k];
  ASSERT_EQ(shine({light}), LW_OK);
  for (const float v : irradiance) ASSERT_TRUE(std::isfinite(v));
}

TEST_F(PrmLights, RejectsLightsOutOfRange) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const lw_light good = pointLight(0, 1, 0, 1);
  auto expectBad = [&](auto change) {
    lw_light light = good;
    change(light);
    EXPECT_EQ(shine({good, light}), LW_INVALID_ARGUMENT);
  };
  expectBad([&](lw_light& l) { l.type = 0; });
  expectBad([&](lw_light& l) { l.position_m[1] = nan; });
  expectBad([&](lw_light& l) { l.intensity_rgb[2] = -1; });
  expectBad([&](lw_light& l) { l.range_m = nan; });
  expectBad([&](lw_light& l) { l.type = LW_LIGHT_DIRECTIONAL, l.direction[1] = 0; });
  expectBad([&](lw_light& l) { l.type = LW_LIGHT_SPOT, l.outer_cone_angle_rad = float(kPi); });
  expectBad([&](lw_light& l) { l.type = LW_LIGHT_SPOT, l.inner_cone_angle_rad = 0.8f; });
}

}  // namespace
}  // namespace lightwell::test
