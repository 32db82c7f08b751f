// Virtual points and the lights that they are clustered into: power, places, planes, outlines.
#include <gtest/gtest.h>

#include <map>

#include "precompute/core/random.h"
#include "precompute/transport/many_lights/outline.h"
#include "precompute/transport/many_lights/planes.h"
#include "precompute/transport/many_lights/virtual_lights.h"
#include "tests/environment/skies.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

std::vector<VirtualPoint> trace(const test::PreparedScene& p, uint32_t paths = 20000) {
  const LightPaths light(p.scene, p.atlas, *p.tracer, p.scene.lights, nullptr, {.paths = paths});
  return light.trace(0, light.count(), nullptr);
}

std::map<uint32_t, Vec3d> powerOfBounces(std::span<const VirtualPoint> points) {
  std::map<uint32_t, Vec3d> power;
  for (const auto& p : points) power.try_emplace(p.bounce, 0.0).first->second += Vec3d(p.power_rgb);
  return power;
}

TEST(LightPaths, InAClosedRoomPowerIsAGeometricSeries) {
  for (const float albedo : {0.3f, 0.8f, 0.99f}) {
    scene::Scene scene = test::closedBox({1, 1.5f, 2}, test::diffuse(albedo));
    scene.lights.push_back(test::pointLight({0.2f, 0.3f, -0.4f}, 2.0f));
    const test::PreparedScene p(std::move(scene), 32);
    const auto power = powerOfBounces(trace(p));
    const double lamp = 2.0 * 4 * double(kPi);
    EXPECT_NEAR(power.at(1).x / (lamp * albedo), 1, 1e-3) << "every path meets a wall";
    double sum = 0;
    for (const auto& [bounce, rgb] : power) sum += rgb.x;
    EXPECT_NEAR(sum / (lamp * albedo / (1 - albedo)), 1, albedo > 0.9f ? 0.05 : 0.02) << albedo;
  }
}

TEST(LightPaths, EmittersShineFromTheirFrontWithTheirPower) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.5f)), lamp = builder.material(test::diffuse(0, 3.0f));
  builder.room({-1, 0, -1}, {1, 2, 1}, wall).quad({-0.25f, 1.9f, -0.25f}, {0.5f, 0, 0}, {0, 0, 0.5f}, lamp);  // front downward
  const test::PreparedScene p(builder.take(), 32);
  const auto points = trace(p);
  const auto power = powerOfBounces(points);
  EXPECT_NEAR(power.at(0).x / (3 * double(kPi) * 0.25), 1, 1e-3);
  EXPECT_NEAR(power.at(1).x / power.at(0).x, 0.5, 0.01);
  for (const auto& v : points) {
    ASSERT_EQ(v.source, 0u) << "there are no lamps, so that emitters are the first source";
    ASSERT_TRUE(v.bounce != 0 || v.normal.y < -0.99f);
  }
}

TEST(LightPaths, ASkyGivesAFloorItsIrradiance) {
  const auto power = [](const std::function<Rgb(const Vec3&)>& radiance) {
    test::SceneBuilder builder;
    builder.quad({-1, 0, -1}, {0, 0, 3}, {2, 0, 0}, builder.material(test::diffuse(0.5f)));  // 6 m², faces up
    scene::Scene scene = builder.take();
    scene.lights.push_back(test::pointLight({0, -1, 0}, 1.0f));  // below: none of it is reflected
    const test::PreparedScene p(std::move(scene), 32);
    Diagnostics diagnostics;
    EnvironmentMap map = makeSky(64, 32, radiance);
    const SkyLight sky(makeSkyGrid(map, 2048, diagnostics, nullptr));
    const LightPaths light(p.scene, p.atlas, *p.tracer, p.scene.lights, &sky, {.paths = 40000});
    double sum = 0;
    for (const VirtualPoint& v : light.trace(0, light.count(), nullptr)) {
      EXPECT_EQ(v.source, 2u) << "lamps, emitters, then the sky";
      EXPECT_EQ(v.bounce, 1u);
      sum += double(v.power_rgb.x);
    }
    return sum / (0.5 * 6);
  };
  EXPECT_NEAR(power([](const Vec3&) { return Rgb(1); }) / double(kPi), 1, 0.01);
  EXPECT_NEAR(power([](const Vec3& d) { return Rgb(std::max(d.y, 0.0f)); }) / (2 * double(kPi) / 3), 1, 0.01);
}

TEST(LightPaths, SpotsAndSunsHaveTheirPower) {
  test::SceneBuilder builder;
  builder.room({-2, 0, -2}, {2, 3, 2}, builder.material(test::diffuse(0.5f)));
  scene::Scene scene = builder.take();
  scene::Light spot = test::pointLight({0, 2, 0}, 4.0f);
  spot.type = scene::LightType::spot;
  spot.inner_cone_angle = 0.3f, spot.outer_cone_angle = 0.8f;
  scene.lights.push_back(spot);
  const test::PreparedScene p(std::move(scene), 32);
  // Quadrature of scene::lightIrradiance over the sphere around the lamp.
  double flux = 0, central_flux = 0;
  const float central = std::cos(0.5f);
  constexpr int kSteps = 4000;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = -1 + 2 * (i + 0.5) / kSteps;
    const Vec3 direction(float(std::sqrt(1 - cosine * cosine)), float(-cosine), 0);
    Vec3 to_light;
    float distance = 0;
    const double part = double(scene::lightIrradiance(p.scene.lights[0], spot.position + direction, -direction, to_light, distance).x) * 4 * double(kPi) / kSteps;
    flux += part;
    if (float(cosine) > central) central_flux += part;
  }
  const auto points = trace(p);
  EXPECT_NEAR(powerOfBounces(points).at(1).x / (0.5 * flux), 1, 2e-3);
  double central_power = 0;
  for (const auto& v : points)
    if (v.bounce == 1 && (spot.position - v.position).normalized().y > central) central_power += double(v.power_rgb.x);
  EXPECT_NEAR(central_power / (0.5 * central_flux), 1, 0.01);

  // A sun on a roofless floor: what falls on 16 square units, at 60 degrees.
  test::SceneBuilder floor;
  floor.quad({-2, 0, -2}, {0, 0, 4}, {4, 0, 0}, floor.material(test::diffuse(0.5f)));
  scene::Scene outside = floor.take();
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.direction = Vec3(std::sqrt(0.75f), -0.5f, 0);
  sun.intensity = Rgb(10);
  outside.lights.push_back(sun);
  const test::PreparedScene q(std::move(outside), 32);
  EXPECT_NEAR(powerOfBounces(trace(q, 65536)).at(1).x / (0.5 * 10 * 0.5 * 16), 1, 0.01);
}

TEST(LightPaths, SingleSidedSurfacesReflectFromTheirFront) {
  for (const bool double_sided : {false, true}) {
    test::SceneBuilder builder;
    scene::Material material = test::diffuse(0.5f);
    material.double_sided = double_sided;
    builder.quad({-1, 0, -1}, {2, 0, 0}, {0, 0, 2}, builder.material(material));  // front downward; the lamp is above
    scene::Scene scene = builder.take();
    scene.lights.push_back(test::pointLight({0, 1, 0}, 1.0f));
    const test::PreparedScene p(std::move(scene), 32);
    const auto points = trace(p);
    EXPECT_EQ(points.empty(), !double_sided);
    for (const auto& v : points) EXPECT_GT(v.normal.y, 0.99f);
  }
}

TEST(LightPaths, DoNotDependOnHowTheyAreCut) {
  scene::Scene scene = test::closedBox({1, 1, 1}, test::diffuse(0.6f, 0.2f));
  scene.lights.push_back(test::pointLight({0.2f, 0.3f, -0.4f}, 2.0f));
  const test::PreparedScene p(std::move(scene), 16);
  const LightPaths light(p.scene, p.atlas, *p.tracer, p.scene.lights, nullptr, {.paths = 3000});
  const auto whole = light.trace(0, light.count(), nullptr);
  std::vector<VirtualPoint> parts;
  for (uint32_t first = 0; first < light.count(); first += 701) {
    const auto part = light.trace(first, std::min(light.count(), first + 701), nullptr);
    parts.insert(parts.end(), part.begin(), part.end());
  }
  ASSERT_EQ(parts.size(), whole.size());
  for (size_t i = 0; i < whole.size(); ++i) ASSERT_EQ(parts[i].position, whole[i].position);
}

TEST(Planes, AreFoundWithTheirNormalsAndPartsApart) {
  std::vector<VirtualPoint> points;
  const Sampler sampler(1, 1);
  const auto add = [&](const Vec3& origin, const Vec3& s, const Vec3& t, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) {
      const Vec2 u = sampler.get2D(uint32_t(points.size()), 0);
      points.push_back({origin + s * u.x + t * u.y, s.cross(t).normalized(), Rgb(1), 0, 1});
    }
  };
  add({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, 300);  // up
  add({9, 0, 0}, {0, 0, 1}, {1, 0, 0}, 300);  // the same plane, far away
  add({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 200);  // the same place, facing down
  add({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 250);
  for (uint32_t i = 0; i < 100; ++i) {        // a ball
    const Vec3 d = Vec3(sampler.get2D(i, 1).x - 0.5f, sampler.get2D(i, 2).y - 0.5f, sampler.get2D(i, 3).x - 0.5f).normalized();
    points.push_back({Vec3(5, 5, 5) + d, d, Rgb(1), 0, 1});
  }
  std::vector<uint32_t> all(points.size());
  for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const DetectedPlanes found = detectPlanes(points, all, {.distance = 1e-4f, .least_points = 20}, nullptr);
  ASSERT_EQ(found.planes.size(), 4u);
  EXPECT_EQ(found.rest.size(), 100u);
  for (const auto& plane : found.planes)
    for (const uint32_t i : plane.points) EXPECT_GT(plane.normal.dot(points[i].normal), 0.9999f);
}

TEST(Outline, GrowsHullsIntoTheirCells) {
  const Polygon2 hull = convexHull({{0.2f, 0.2f}, {0.8f, 0.2f}, {0.8f, 0.8f}, {0.2f, 0.8f}, {0.5f, 0.5f}, {0.5f, 0.2f}});
  ASSERT_EQ(hull.size(), 4u);
  EXPECT_NEAR(areaOf(hull), 0.36, 1e-6);
  const Polygon2 cell{{0, 0}, {1, 0}, {1, 0.9f}, {0, 0.9f}};
  EXPECT_NEAR(areaOf(grownInto(cell, hull, 0.1f)), 0.64, 1e-6);
  EXPECT_NEAR(areaOf(grownInto(cell, hull, 5)), 0.9, 1e-6);
  Polygon2 round;
  for (int i = 0; i < 64; ++i) round.emplace_back(std::cos(float(i) * kPi / 32), std::sin(float(i) * kPi / 32));
  EXPECT_EQ(simplified(round, 8).size(), 8u);
  EXPECT_NEAR(areaOf(simplified(round, 8)), 2 * std::sqrt(2.0), 0.3);
  const Vec2 along = alignment({{0, 0}, {2, 1}, {1.5f, 2}, {-0.5f, 1}});
  EXPECT_NEAR(std::abs(along.x * 2 + along.y) * std::abs(along.x - 2 * along.y), 0, 1e-5) << "along a side of the rectangle";
}

class Clusters : public testing::TestWithParam<std::optional<VirtualLightType>> {};

TEST_P(Clusters, KeepPowerAndCount) {
  scene::Scene scene = test::closedBox({1, 1.5f, 2}, test::diffuse(0.5f, 0.1f));
  scene.lights.push_back(test::pointLight({0.2f, 0.3f, -0.4f}, 2.0f));
  const test::PreparedScene p(std::move(scene), 32);
  const auto points = trace(p);
  const auto lights = clusterPoints(points, 3, {.lights = 200, .type = GetParam()});
  EXPECT_NEAR(double(lights.size()), 200, 10);
  double before = 0, after = 0;
  for (const auto& v : points) before += double(v.power_rgb.x);
  for (const auto& light : lights) {
    after += double(light.power_rgb.x);
    EXPECT_EQ(light.type, GetParam().value_or(light.type));
    EXPECT_EQ(light.vertices.empty(), light.type != VirtualLightType::polygon);
    EXPECT_LE(light.vertices.size(), 8u);
    for (const Vec3& v : light.vertices) {
      EXPECT_NEAR(light.normal.dot(v - light.position), 0, 1e-4f);
      EXPECT_LT(std::max({std::abs(v.x) - 1.0f, std::abs(v.y) - 1.5f, std::abs(v.z) - 2.0f}), 1e-3f) << "nothing shines from outside of the walls";
    }
  }
  EXPECT_NEAR(after / before, 1, 1e-4);
  const auto again = readVirtualLights(toBytes(lights));
  ASSERT_EQ(again.size(), lights.size());
  EXPECT_EQ(again.back().vertices, lights.back().vertices);
}

INSTANTIATE_TEST_SUITE_P(All, Clusters, testing::Values(std::nullopt, VirtualLightType::point, VirtualLightType::disk, VirtualLightType::sphere, VirtualLightType::polygon));

TEST(ClustersWithoutADirection, ShineFromOneOfTheirPointsWithAllTheirPower) {
  // Ten points on each of two walls that face each other, for one light; many sources, so that what is picked is told apart.
  constexpr uint32_t kSources = 400;
  std::vector<VirtualPoint> points;
  for (uint32_t source = 0; source < kSources; ++source)
    for (uint32_t i = 0; i < 20; ++i) {
      const bool right = i % 2 == 1;
      points.push_back({Vec3(right ? 1.0f : -1.0f, 0.01f * float(i % 7), 0.02f * float(i % 3)), Vec3(right ? -1.0f : 1.0f, 0, 0), Rgb(right ? 1.5f : 1.0f), source, 1});
    }
  const auto lights = clusterPoints(points, 1.5f, {.lights = 1});
  ASSERT_EQ(lights.size(), kSources);
  uint32_t from_right = 0;
  for (const VirtualLight& light : lights) {
    EXPECT_FLOAT_EQ(light.power_rgb.x, 25.0f);
    EXPECT_NEAR(std::abs(light.position.x), 1.0f, 1e-3f) << "on a wall, not between";
    EXPECT_NEAR(light.normal.x * light.position.x, -1.0f, 1e-3f) << "away from it";
    from_right += light.position.x > 0;
  }
  EXPECT_NEAR(from_right / double(kSources), 0.6, 0.08) << "as often as it has power";
}

TEST(ClustersOfEmitters, AreTheEmitter) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0)), lamp = builder.material(test::diffuse(0, 1));
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, wall).quad({-0.25f, 1.9f, -0.5f}, {0.5f, 0, 0}, {0, 0, 1.0f}, lamp);
  const test::PreparedScene p(builder.take(), 32);
  const auto lights = clusterPoints(trace(p), 1.5f, {.lights = 10});
  double area = 0;
  for (const auto& light : lights) {
    if (light.bounce != 0) continue;
    EXPECT_EQ(light.type, VirtualLightType::polygon);
    for (size_t i = 2; i < light.vertices.size(); ++i)
      area += 0.5 * double((light.vertices[i - 1] - light.vertices[0]).cross(light.vertices[i] - light.vertices[0]).length());
  }
  EXPECT_NEAR(area, 0.5, 0.01);
}

}  // namespace
}  // namespace lightwell::transport
