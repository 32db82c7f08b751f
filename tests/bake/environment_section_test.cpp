// The section environment: what the runtime answers from a container is what the bake's own evaluator answers, and the truth.
#include <gtest/gtest.h>

#include "format/encode/verify.h"
#include "precompute/bake/sections.h"
#include "precompute/core/random.h"
#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/evaluate_environment.h"
#include "precompute/transport/environment/exact_environment.h"
#include "precompute/transport/environment/ggx_lobes.h"
#include "precompute/transport/environment/sky_harmonics.h"
#include "tests/environment/skies.h"
#include "tests/runtime/support.h"

namespace lightwell::bake {
namespace {

using namespace transport;
using test::openMemory;
using Handle = std::unique_ptr<lw_environment, decltype(&lw_environment_release)>;

Environment bakeOf(EnvironmentMap& map, uint32_t samples = 128) {
  Diagnostics diagnostics;
  EnvironmentSettings settings;
  settings.decomposition.samples = samples;
  settings.decomposition.threads = 2;
  return bakeEnvironment(map, settings, diagnostics, nullptr);
}

std::vector<uint8_t> containerOf(const Environment& environment) {
  format::Writer writer;
  addEnvironmentSection(writer, environment, {});
  return writer.bytes();
}

Handle load(const lw_container* container) {
  lw_environment* environment = nullptr;
  EXPECT_EQ(lw_environment_load(container, &environment), LW_OK);
  return {environment, lw_environment_release};
}

std::vector<Vec3> directions(uint32_t count) {
  std::vector<Vec3> result;
  const Sampler sampler(17, 4);
  for (uint32_t i = 0; i < count; ++i) result.push_back(uniformDirection(sampler.get2D(i, 0)));
  return result;
}

struct RelativeRms {
  double difference = 0, power = 0;
  void add(const Rgb& exact, const Rgb& answer) { difference += (answer - exact).length2(), power += exact.length2(); }
  double value() const { return std::sqrt(difference / power); }
};

class EnvironmentSection : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    map_ = new EnvironmentMap(makeSky(512, 256, outdoorRadiance));
    environment_ = new Environment(bakeOf(*map_));
    bytes_ = new std::vector<uint8_t>(containerOf(*environment_));
  }
  static void TearDownTestSuite() {
    delete map_;
    delete environment_;
    delete bytes_;
  }
  EnvironmentSection() : container_(openMemory(*bytes_)), handle_(load(container_.get())) {}
  Rgb phong(const Vec3& axis, float n, const std::vector<float>& visibility = {}) const {
    Rgb answer;
    EXPECT_EQ(lw_environment_phong(handle_.get(), &axis.x, n, visibility.empty() ? nullptr : visibility.data(), &answer.x), LW_OK);
    return answer;
  }

  inline static EnvironmentMap* map_;
  inline static Environment* environment_;
  inline static std::vector<uint8_t>* bytes_;
  test::Container container_;
  Handle handle_;
};

TEST_F(EnvironmentSection, IsSoundAndCarriesTheCells) {
  const auto issues = format::verify(format::memorySource(bytes_->data(), bytes_->size()));
  EXPECT_TRUE(issues.empty()) << issues[0].place << ": " << issues[0].message;
  lw_environment_info info;
  ASSERT_EQ(lw_environment_get_info(handle_.get(), &info), LW_OK);
  EXPECT_EQ(info.cells, environment_->cells.count());
  EXPECT_EQ(info.suns, 1u);
  EXPECT_NEAR(info.max_shininess, EnvironmentEvaluator(*environment_).maxShininess(), 1);
  lw_environment_cells cells;
  ASSERT_EQ(lw_environment_get_cells(handle_.get(), &cells), LW_OK);
  for (uint32_t i = 0; i < info.cells; ++i) {
    Vec3 tangent, bitangent;
    orthonormalBasis(environment_->cells.direction[i], tangent, bitangent);
    for (int c = 0; c < 3; ++c) {
      EXPECT_EQ(cells.direction[3 * i + uint32_t(c)], environment_->cells.direction[i][c]);
      EXPECT_EQ(cells.flux_rgb[3 * i + uint32_t(c)], environment_->cells.flux_rgb[i][c]);
      EXPECT_NEAR(cells.tangent[3 * i + uint32_t(c)], tangent[c], 1e-6);
    }
    EXPECT_NEAR(cells.cos_radius[i], environment_->cells.cos_radius[i], 1e-6);
  }
}

TEST_F(EnvironmentSection, AnswersLikeTheBakesEvaluator) {
  const EnvironmentEvaluator evaluator(*environment_);
  for (const float n : {1.0f, 2.5f, 10.0f, 100.0f, 1000.0f, 1e5f}) {
    RelativeRms error;
    for (const Vec3& axis : directions(100)) error.add(evaluator.answer({axis, n}), phong(axis, n));
    EXPECT_LT(error.value(), 2e-5) << n;
  }
  RelativeRms ggx, harmonics;
  lw_environment_info info;
  ASSERT_EQ(lw_environment_get_info(handle_.get(), &info), LW_OK);
  for (const Vec3& axis : directions(40)) {
    for (const float roughness : {0.1f, 0.36f, 0.62f, 0.93f}) {
      Rgb radiance;
      ASSERT_EQ(lw_environment_ggx(handle_.get(), &axis.x, roughness, nullptr, &radiance.x), LW_OK);
      ggx.add(evaluator.ggxRadiance(axis, roughness), radiance);
    }
    Rgb irradiance;
    ASSERT_EQ(lw_sh_irradiance(info.sky_radiance_sh, &axis.x, &irradiance.x), LW_OK);
    harmonics.add(irradianceFromHarmonics(environment_->sky.radiance_sh, axis), irradiance);
  }
  EXPECT_LT(ggx.value(), 2e-3);  // weights interpolated in a table
  EXPECT_LT(harmonics.value(), 1e-5);
}

TEST_F(EnvironmentSection, MeetsTheTargets) {
  Diagnostics diagnostics;
  for (const auto& [n, limit] : {std::pair{1.0f, 0.0025}, std::pair{10.0f, 0.005}, std::pair{100.0f, 0.02}, std::pair{1000.0f, 0.05}}) {
    std::vector<EnvironmentQuery> queries;
    for (const Vec3& axis : directions(60)) queries.push_back({axis, n});
    const std::vector<Rgb> exact = exactAnswers(*map_, queries, 2, diagnostics, nullptr);
    RelativeRms error;
    for (size_t i = 0; i < queries.size(); ++i) error.add(exact[i], phong(queries[i].axis, n));
    EXPECT_LT(error.value(), limit) << n;
  }
}

/// Hiding all cells leaves nothing of the light, and hiding some leaves about the others' share.
TEST_F(EnvironmentSection, HiddenCellsAreTakenAway) {
  const uint32_t count = environment_->cells.count();
  const EnvironmentEvaluator evaluator(*environment_);
  for (const float n : {1.0f, 20.0f}) {
    RelativeRms dark, part;
    for (const Vec3& axis : directions(60)) {
      const Rgb all = phong(axis, n);
      dark.add(all, all + phong(axis, n, std::vector<float>(count, 0.0f)));
      std::vector<float> visibility(count, 1.0f);
      for (uint32_t i = 0; i < count; ++i) visibility[i] = i % 3 == 0 ? 0.0f : i % 3 == 1 ? 0.5f : 1.0f;
      Rgb cells(0, 0, 0);
      for (uint32_t i = 0; i < count; ++i)
        cells += environment_->cells.flux_rgb[i] * visibility[i] *
                 (n == 1 ? averageCosine(Reflectivity::spread, cellShape(environment_->cells, i), axis)
                         : averageCosinePower(Reflectivity::spread, cellShape(environment_->cells, i), axis, n));
      part.add(cells, phong(axis, n, visibility));
    }
    EXPECT_LT(dark.value(), 0.02) << n;
    EXPECT_LT(part.value(), 0.02) << n;
  }
}

TEST_F(EnvironmentSection, RefusesWhatMakesNoSense) {
  const float up[3] = {0, 1, 0}, zero[3] = {0, 0, 0}, nan[3] = {NAN, 0, 0};
  float rgb[3];
  lw_phong_lobe lobes[4];
  EXPECT_EQ(lw_environment_phong(handle_.get(), up, 0.5f, nullptr, rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_environment_phong(handle_.get(), up, 2e5f, nullptr, rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_environment_phong(handle_.get(), zero, 5, nullptr, rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_environment_irradiance(handle_.get(), nan, nullptr, rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_environment_irradiance(handle_.get(), up, std::vector<float>(128, 1.5f).data(), rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_environment_ggx(handle_.get(), up, 1.5f, nullptr, rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_environment_irradiance(nullptr, up, nullptr, rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_ggx_lobes(-1, lobes), LW_INVALID_ARGUMENT);
  lw_environment* none = nullptr;
  EXPECT_EQ(lw_environment_load(openMemory(format::Writer().bytes()).get(), &none), LW_NOT_FOUND);
}

TEST_F(EnvironmentSection, NeedsNoMoreThanItsMemory) {
  for (size_t fail_at = 0;; ++fail_at) {
    test::Host host;
    host.fail_at = fail_at;
    const lw_config config = host.config();
    lw_container* container = nullptr;
    lw_result result = lw_open_memory(bytes_->data(), bytes_->size(), &config, &container);
    lw_environment* environment = nullptr;
    if (result == LW_OK) result = lw_environment_load(container, &environment);
    lw_environment_release(environment);
    lw_close(container);
    EXPECT_EQ(host.live, 0u);
    if (result == LW_OK) break;
    ASSERT_EQ(result, LW_OUT_OF_MEMORY) << fail_at;
    ASSERT_LT(fail_at, 200u);
  }
}

TEST(EnvironmentAnswers, ConstantSkyIsPiAndTheLobesIntegral) {
  EnvironmentMap map = makeSky(64, 32, [](const Vec3&) { return Rgb(1, 2, 4); });
  const auto bytes = containerOf(bakeOf(map, 32));
  const auto container = openMemory(bytes);
  const Handle environment = load(container.get());
  for (const Vec3& axis : directions(50)) {
    Rgb irradiance, lobe, ggx;
    ASSERT_EQ(lw_environment_irradiance(environment.get(), &axis.x, nullptr, &irradiance.x), LW_OK);
    ASSERT_EQ(lw_environment_phong(environment.get(), &axis.x, 300, nullptr, &lobe.x), LW_OK);
    ASSERT_EQ(lw_environment_ggx(environment.get(), &axis.x, 0.4f, nullptr, &ggx.x), LW_OK);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(irradiance[c] / (kPi * float(1 << c)), 1, 1e-5);
      EXPECT_NEAR(lobe[c] * 301 / (2 * kPi * float(1 << c)), 1, 2e-4);
      EXPECT_NEAR(ggx[c] / float(1 << c), 1, 2e-4);
    }
  }
}

TEST(EnvironmentAnswers, AreFiniteForExtremeSkies) {
  const auto dark = [](const Vec3&) { return Rgb(0, 0, 0); };
  const auto spot = [](const Vec3& d) { return d.x > 0.999f ? Rgb(1e6f) : Rgb(0); };
  const auto blinding = [](const Vec3&) { return Rgb(1e12f); };
  for (const std::function<Rgb(const Vec3&)>& radiance : {std::function<Rgb(const Vec3&)>(dark), {spot}, {blinding}}) {
    EnvironmentMap map = makeSky(64, 32, radiance);
    const auto bytes = containerOf(bakeOf(map, 16));
    const auto issues = format::verify(format::memorySource(bytes.data(), bytes.size()));
    EXPECT_TRUE(issues.empty()) << issues[0].place << ": " << issues[0].message;
    const auto container = openMemory(bytes);
    const Handle environment = load(container.get());
    for (const Vec3& axis : directions(30))
      for (const float n : {1.0f, 3.0f, 1e3f, 1e5f})
        for (const float visible : {0.0f, 0.3f, 1.0f}) {
          Rgb answer;
          const std::vector<float> visibility(16, visible);
          ASSERT_EQ(lw_environment_phong(environment.get(), &axis.x, n, visibility.data(), &answer.x), LW_OK);
          EXPECT_TRUE(isFinite(answer) && answer.x >= 0 && answer.y >= 0 && answer.z >= 0);
        }
  }
}

/// The table's lobes against the fits that it was made from, also between its rows.
TEST(EnvironmentAnswers, GgxLobesAreTheFits) {
  for (const float roughness : {0.0f, 0.08f, 0.19f, 0.33f, 0.487f, 0.61f, 0.76f, 0.94f, 1.0f}) {
    lw_phong_lobe lobes[4];
    ASSERT_EQ(lw_ggx_lobes(roughness, lobes), LW_OK);
    const std::vector<PhongLobe> fit = ggxLobes(roughness);
    double weight = 0, difference = 0;
    const auto add = [](double psi, const auto& all) {
      double sum = 0;
      for (const auto& lobe : all)
        sum += double(lobe.weight) * (double(lobe.shininess) + 1) / (2 * std::numbers::pi) * std::exp(lobe.shininess * std::log(std::cos(psi)));
      return sum;
    };
    for (const auto& lobe : lobes) weight += lobe.weight;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      const double s = (i + 0.5) / steps, psi = s * s * s * std::numbers::pi / 2;
      difference += std::abs(add(psi, lobes) - add(psi, fit)) * 2 * std::numbers::pi * std::sin(psi) * 3 * s * s * std::numbers::pi / 2 / steps;
    }
    EXPECT_NEAR(weight, 1, 1e-4) << roughness;
    EXPECT_LT(difference, 5e-3) << roughness;
  }
}

}  // namespace
}  // namespace lightwell::bake
