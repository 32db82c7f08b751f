// Where lights that move are taken to be: each prior keeps to its places and covers them evenly.
#include "precompute/transport/prm/light_prior.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

using Places = LightPrior::Places;
constexpr uint32_t kLights = 512;

/// A floor and, 3 m above it, a ceiling of half its size; their fronts face each other.
test::PreparedScene hall() {
  test::SceneBuilder builder;
  const uint32_t grey = builder.material(test::diffuse(0.5f));
  builder.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, grey);
  builder.quad({-1, 3, -2}, {2, 0, 0}, {0, 0, 4}, grey);
  return test::PreparedScene(builder.take(), 32);
}

std::vector<PriorLight> sample(const test::PreparedScene& p, const LightPrior& prior, uint32_t count = kLights) {
  return samplePriorLights(p.scene, p.atlas, *p.tracer, prior, count, 7);
}

TEST(LightPrior, LampsUnderCeilingsHangNearThem) {
  const auto p = hall();
  const auto lights = sample(p, {.places = Places::ceilings});
  ASSERT_EQ(lights.size(), kLights);
  double mean_x = 0;
  for (const auto& [light, distance_m] : lights) {
    EXPECT_EQ(light.type, scene::LightType::point);
    EXPECT_LE(std::abs(light.position.x), 1.001f);
    EXPECT_GE(light.position.y, 3 - 0.351f * 3);
    EXPECT_LE(light.position.y, 3 - 0.049f * 3);
    EXPECT_NEAR(distance_m, 3 - light.position.y, 1e-3f);
    mean_x += light.position.x / kLights;
  }
  EXPECT_NEAR(mean_x, 0, 4 * 0.58 / std::sqrt(double(kLights)));
  test::SceneBuilder builder;
  builder.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, builder.material(test::diffuse(0.5f)));
  EXPECT_TRUE(sample(test::PreparedScene(builder.take(), 32), {.places = Places::ceilings}).empty()) << "nothing looks down";
}

TEST(LightPrior, SunsAreSpreadOverTheSkyByItsSolidAngle) {
  const auto lights = sample(hall(), {.places = Places::sun});
  ASSERT_EQ(lights.size(), kLights);
  int high = 0, east = 0;
  for (const auto& [light, distance_m] : lights) {
    EXPECT_EQ(light.type, scene::LightType::directional);
    EXPECT_NEAR(light.direction.length(), 1, 1e-5f);
    ASSERT_LE(light.direction.y, 0) << "light travels downwards";
    high += light.direction.y < -0.5f;  // half of the hemisphere is above 30 degrees
    east += light.direction.x < 0;
    EXPECT_TRUE(std::isinf(distance_m));
  }
  EXPECT_NEAR(high, 256, 12);
  EXPECT_NEAR(east, 256, 12);
}

TEST(LightPrior, LampsOfTheSceneStayWhereTheyAreAndAreWhite) {
  auto p = hall();
  scene::Light spot;
  spot.type = scene::LightType::spot;
  spot.position = {0.5f, 2, 0};
  spot.intensity = {100, 0, 0};
  p.scene.lights = {spot, {}};
  const auto lights = sample(p, {.places = Places::lamps});
  ASSERT_EQ(lights.size(), 2u);
  EXPECT_EQ(lights[0].light.type, scene::LightType::spot);
  EXPECT_EQ(lights[0].light.position.x, 0.5f);
  EXPECT_EQ(lights[0].light.intensity.x, lights[0].light.intensity.y);
  p.scene.lights.clear();
  EXPECT_TRUE(sample(p, {.places = Places::lamps}).empty());
}

TEST(LightPrior, PathsAreVisitedByTheirLength) {
  LightPrior prior{.places = Places::paths};
  prior.paths = {{{0, 1, 0}, {3, 1, 0}}, {{0, 2, 0}, {0, 2, 1}}};
  int first = 0;
  for (const auto& [light, distance_m] : sample(hall(), prior)) {
    const Vec3& at = light.position;
    const bool on_first = at.y == 1;
    first += on_first;
    ASSERT_TRUE(on_first ? at.x >= 0 && at.x <= 3 && at.z == 0 : at.x == 0 && at.y == 2 && at.z >= 0 && at.z <= 1);
  }
  EXPECT_NEAR(first, 384, 12);
  prior.paths = {{{1, 1, 1}}};
  for (const auto& [light, distance_m] : sample(hall(), prior, 4)) EXPECT_EQ(light.position.x, 1);
}

TEST(LightPrior, ALightDoesNotDependOnTheirNumber) {
  const auto p = hall();
  LightPrior paths{.places = Places::paths, .paths = {{{0, 1, 0}, {3, 1, 0}}}};
  for (const LightPrior& prior : {LightPrior{}, LightPrior{.places = Places::ceilings}, LightPrior{.places = Places::sun}, paths}) {
    const auto few = sample(p, prior, 5), many = sample(p, prior, 50);
    for (size_t i = 0; i < few.size(); ++i) {
      EXPECT_EQ(few[i].light.position.x, many[i].light.position.x);
      EXPECT_EQ(few[i].light.direction.x, many[i].light.direction.x);
    }
  }
}

}  // namespace
}  // namespace lightwell::transport
