#include "precompute/transport/environment/evaluate_environment.h"

#include <gtest/gtest.h>

#include "precompute/core/random.h"
#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/exact_environment.h"
#include "precompute/transport/environment/sky_harmonics.h"
#include "precompute/transport/environment/sky_nodes.h"
#include "tests/environment/skies.h"

namespace lightwell::transport {
namespace {

Environment bake(EnvironmentMap& map, uint32_t samples = 128, int threads = 2) {
  Diagnostics diagnostics;
  EnvironmentSettings settings;
  settings.decomposition.samples = samples;
  settings.decomposition.threads = threads;
  return bakeEnvironment(map, settings, diagnostics, nullptr);
}
std::vector<EnvironmentQuery> queriesOf(float shininess, uint32_t count) {
  std::vector<EnvironmentQuery> queries;
  const Sampler sampler(11, uint64_t(shininess));
  for (uint32_t i = 0; i < count; ++i) queries.push_back({uniformDirection(sampler.get2D(i, 0)), shininess});
  return queries;
}
double relativeRms(const std::vector<Rgb>& exact, const std::vector<Rgb>& answer) {
  double difference = 0, power = 0;
  for (size_t i = 0; i < exact.size(); ++i) difference += (answer[i] - exact[i]).length2(), power += exact[i].length2();
  return std::sqrt(difference / power);
}

TEST(EnvironmentEvaluator, ConstantSkyGivesPi) {
  for (const auto& [width, height] : {std::pair{64, 32}, std::pair{513, 200}, std::pair{1024, 512}}) {
    EnvironmentMap map = makeSky(width, height, [](const Vec3&) { return Rgb(1, 1, 1); });
    const EnvironmentEvaluator evaluator(bake(map, 32));
    for (const EnvironmentQuery& query : queriesOf(1, 50)) EXPECT_NEAR(evaluator.answer(query).x / kPi, 1, 1e-5) << width;
    for (float n : {10.0f, 100.0f, 1000.0f})
      for (const EnvironmentQuery& query : queriesOf(n, 20)) EXPECT_NEAR(evaluator.answer(query).y * (n + 1) / (2 * kPi), 1, 2e-4) << n;
  }
}

TEST(EnvironmentEvaluator, MeetsTheTargetsOnAnOutdoorSky) {
  EnvironmentMap map = makeSky(1024, 512, outdoorRadiance);
  const Environment environment = bake(map);
  EXPECT_EQ(environment.cells.sun_count, 1u);
  const EnvironmentEvaluator evaluator(environment);
  Diagnostics diagnostics;
  for (const auto& [n, sky_limit, cells_limit] :
       {std::tuple{1.0f, 0.0025, 0.005}, std::tuple{10.0f, 0.005, 0.01}, std::tuple{100.0f, 0.02, 0.06}, std::tuple{1000.0f, 0.05, 0.5}}) {
    const std::vector<EnvironmentQuery> queries = queriesOf(n, 100);
    const std::vector<Rgb> exact = exactAnswers(map, queries, 2, diagnostics, nullptr);
    std::vector<Rgb> sky, cells;
    for (const EnvironmentQuery& query : queries) {
      sky.push_back(evaluator.answer(query));
      cells.push_back(evaluator.answerFromCells(query, Reflectivity::spread));
    }
    EXPECT_LT(relativeRms(exact, sky), sky_limit) << n;
    EXPECT_LT(relativeRms(exact, cells), cells_limit) << n;
  }
}

TEST(EnvironmentEvaluator, MoreCellsMeanLessError) {
  EnvironmentMap map = makeSky(512, 256, outdoorRadiance);
  Diagnostics diagnostics;
  const std::vector<EnvironmentQuery> queries = queriesOf(20, 100);
  const std::vector<Rgb> exact = exactAnswers(map, queries, 2, diagnostics, nullptr);
  const auto error = [&](uint32_t samples) {
    const EnvironmentEvaluator evaluator(bake(map, samples));
    std::vector<Rgb> answers;
    for (const EnvironmentQuery& query : queries) answers.push_back(evaluator.answerFromCells(query, Reflectivity::spread));
    return relativeRms(exact, answers);
  };
  // Monte Carlo would halve; second-order cells gain nearly 16.
  EXPECT_LT(error(512), 0.25 * error(32) / 2);
}

TEST(EnvironmentEvaluator, TurningTheMapTurnsTheAnswers) {
  MapPlacement turned;
  turned.world_from_map = rotationAboutY(0.7);
  const double c = std::cos(1.1), s = std::sin(1.1);
  turned.world_from_map = turned.world_from_map * Imath::M33d(1, 0, 0, 0, c, -s, 0, s, c);
  EnvironmentMap straight = makeSky(512, 256, outdoorRadiance), tilted = makeSky(512, 256, outdoorRadiance, turned);
  const EnvironmentEvaluator a(bake(straight)), b(bake(tilted));
  const Imath::M33d& m = turned.world_from_map;
  for (float n : {1.0f, 30.0f}) {
    std::vector<Rgb> before, after;
    for (EnvironmentQuery query : queriesOf(n, 60)) {
      before.push_back(a.answer(query));
      const Vec3d d(query.axis);
      query.axis = Vec3(Vec3d(m[0][0] * d.x + m[0][1] * d.y + m[0][2] * d.z, m[1][0] * d.x + m[1][1] * d.y + m[1][2] * d.z,
                              m[2][0] * d.x + m[2][1] * d.y + m[2][2] * d.z));
      after.push_back(b.answer(query));
    }
    EXPECT_LT(relativeRms(before, after), 1e-3) << n;
  }
}

TEST(EnvironmentEvaluator, EverythingIsFinite) {
  const auto dark = [](const Vec3&) { return Rgb(0, 0, 0); };
  const auto contrast = [](const Vec3& d) { return d.x > 0.999f ? Rgb(1e6f) : Rgb(1); };
  const auto blinding = [](const Vec3&) { return Rgb(1e12f); };
  for (const std::function<Rgb(const Vec3&)>& radiance : {std::function<Rgb(const Vec3&)>(dark), {contrast}, {blinding}}) {
    EnvironmentMap map = makeSky(64, 32, radiance);
    const EnvironmentEvaluator evaluator(bake(map, 16));
    for (float n : {1.0f, 2.5f, 1e3f, 1e5f})
      for (const EnvironmentQuery& query : queriesOf(n, 20)) {
        EXPECT_TRUE(isFinite(evaluator.answer(query)));
        for (Reflectivity model : {Reflectivity::single, Reflectivity::paper, Reflectivity::vmf, Reflectivity::spread}) {
          const Rgb value = evaluator.answerFromCells(query, model);
          EXPECT_TRUE(isFinite(value) && value.x >= 0);
        }
      }
  }
}

TEST(EnvironmentEvaluator, SameBytesForAnyNumberOfThreads) {
  EnvironmentMap map = makeSky(256, 128, outdoorRadiance);
  const Environment one = bake(map, 32, 1), three = bake(map, 32, 3);
  EXPECT_EQ(one.sky.value, three.sky.value);
  EXPECT_EQ(one.sky.radiance_sh, three.sky.radiance_sh);
  EXPECT_EQ(one.cells.flux_rgb, three.cells.flux_rgb);
}

TEST(SkyNodes, IntegrateCubicsOfAFaceExactly) {
  SkyNodes nodes(16);
  const Vec3d direction = Vec3d(1, 0.37, -0.81).normalized();
  nodes.splat(direction, {2, 0, 0});
  const auto f = [](const Vec3d& d) {  // a cubic in the face's own coordinates
    const double u = std::atan(d.y / d.x), v = std::atan(d.z / d.x);
    return 1 + u - 2 * v + u * v * v - 3 * u * u * u + v * v * v * u * u;
  };
  double sum = 0;
  for (size_t n = 0; n < nodes.mass_rgb.size(); ++n)
    if (nodes.mass_rgb[n][0] != 0) sum += nodes.mass_rgb[n][0] * f(SkyNodes::direction(16, n));
  EXPECT_NEAR(sum, 2 * f(direction), 1e-12);
  double coarse_sum = 0;
  const SkyNodes coarse = nodes.coarser();
  for (size_t n = 0; n < coarse.mass_rgb.size(); ++n)
    if (coarse.mass_rgb[n][0] != 0) coarse_sum += coarse.mass_rgb[n][0] * f(SkyNodes::direction(8, n));
  EXPECT_NEAR(coarse_sum, 2 * f(direction), 1e-12);
}

TEST(SkyNodes, UniformMassesAddToTheSphere) {
  for (uint32_t m : {16u, 64u}) {
    double sum = 0;
    for (double mass : uniformNodeMass(m)) sum += mass;
    EXPECT_NEAR(6 * sum / (4 * std::numbers::pi), 1, 1e-9);
  }
}

TEST(SkyHarmonics, GiveTheIrradianceOfAGradient) {
  // L = 1 + y: irradiance π + 2π/3 n.y, exactly within the first two bands.
  EnvironmentMap map = makeSky(512, 256, [](const Vec3& d) { return Rgb(1 + d.y); });
  const EnvironmentSky sky = bake(map, 8).sky;
  for (const EnvironmentQuery& query : queriesOf(1, 20))
    EXPECT_NEAR(irradianceFromHarmonics(sky.radiance_sh, query.axis).x, kPi + 2 * kPi / 3 * query.axis.y, 1e-4);
}

TEST(ExactAnswers, AgreeWithClosedForms) {
  Diagnostics diagnostics;
  EnvironmentMap half = makeSky(256, 128, [](const Vec3& d) { return d.y > 0 ? Rgb(1) : Rgb(0); });
  // A lit upper half: irradiance (1 + n.y) π / 2.
  const Vec3 tilted = Vec3(1, 1, 0).normalized();
  const std::vector<EnvironmentQuery> queries = {{Vec3(0, 1, 0), 1}, {Vec3(1, 0, 0), 1}, {tilted, 1}, {Vec3(0, 1, 0), 50000}};
  const std::vector<Rgb> exact = exactAnswers(half, queries, 1, diagnostics, nullptr);
  EXPECT_NEAR(exact[0].x, kPi, 1e-3);
  EXPECT_NEAR(exact[1].x, kPi / 2, 1e-3);
  EXPECT_NEAR(exact[2].x, (1 + tilted.y) * kPi / 2, 1e-3);
  EXPECT_NEAR(exact[3].x * 50001 / (2 * kPi), 1, 1e-2);
}

}  // namespace
}  // namespace lightwell::transport
