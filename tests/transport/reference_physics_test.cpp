// The reference against what physics says in closed form.
#include <gtest/gtest.h>

#include "precompute/core/random.h"
#include "precompute/transport/reference/reference.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

using test::closedBox;
using test::diffuse;
using test::meanOverArea;
using test::pointLight;
using test::quadAtlas;
using test::SceneBuilder;

IrradianceMap render(const scene::Scene& scene, const atlas::Atlas& atlas, Component component, uint32_t samples, uint64_t seed = 1) {
  const trace::Tracer tracer(scene);
  ReferenceOptions options;
  options.samples = samples;
  options.seed = seed;
  return referenceIrradiance(scene, atlas, tracer, scene.lights, component, options);
}
double meanIrradiance(const scene::Scene& scene, const atlas::Atlas& atlas, Component component, uint32_t samples) {
  return meanOverArea(atlas, render(scene, atlas, component, samples).irradiance_rgb);
}

TEST(Furnace, EveryTexelOfAClosedEmittingRoomReceivesPiOverOneMinusAlbedo) {
  const scene::Scene scene = closedBox(Vec3(5), diffuse(0.5f, 1.0f));
  const atlas::Atlas atlas = quadAtlas(scene, 8);
  const IrradianceMap map = render(scene, atlas, Component::total, 256);
  EXPECT_NEAR(meanOverArea(atlas, map.irradiance_rgb) / (2 * kPi), 1, 0.003);
  for (const Rgb& e : map.irradiance_rgb) EXPECT_NEAR(e.x / (2 * kPi), 1, 0.2);
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::direct, 64) / kPi, 1, 0.002);
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::indirect, 256) / kPi, 1, 0.005);
}

TEST(Furnace, HoldsForWallsThatAbsorbNextToNothing) {
  for (const auto& [albedo, samples, tolerance] : {std::tuple{0.99f, 256u, 0.04}, std::tuple{0.999f, 32u, 0.13}}) {
    const scene::Scene scene = closedBox(Vec3(5), diffuse(albedo, 1.0f));
    const atlas::Atlas atlas = quadAtlas(scene, 2);  // the relative deviation of one sample is about 1
    const IrradianceMap map = render(scene, atlas, Component::total, samples);
    EXPECT_NEAR(meanOverArea(atlas, map.irradiance_rgb) * (1 - albedo) / kPi, 1, tolerance) << albedo;
    for (const Rgb& e : map.irradiance_rgb) EXPECT_TRUE(isFinite(e));
  }
}

TEST(FormFactor, FacingUnitSquaresAtUnitDistance) {
  SceneBuilder builder;
  const uint32_t lamp = builder.material(diffuse(0, 1)), black = builder.material(diffuse(0));
  builder.quad(Vec3(-0.5f, 0, -0.5f), Vec3(0, 0, 1), Vec3(1, 0, 0), black);   // faces up
  builder.quad(Vec3(-0.5f, 1, -0.5f), Vec3(1, 0, 0), Vec3(0, 0, 1), lamp);    // faces down
  const scene::Scene scene = builder.take();
  const atlas::Atlas atlas = quadAtlas(scene, 16, {0});
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::direct, 256) / (0.199825 * kPi), 1, 0.002);
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::total, 256) / (0.199825 * kPi), 1, 0.002);
  EXPECT_EQ(meanIrradiance(scene, atlas, Component::indirect, 64), 0);
}

TEST(FormFactor, CoincidentEmittersShineOnce) {
  SceneBuilder builder;
  const uint32_t lamp = builder.material(diffuse(0, 1)), black = builder.material(diffuse(0));
  builder.quad(Vec3(-0.5f, 0, -0.5f), Vec3(0, 0, 1), Vec3(1, 0, 0), black);
  for (int i = 0; i < 2; ++i) builder.quad(Vec3(-0.5f, 1, -0.5f), Vec3(1, 0, 0), Vec3(0, 0, 1), lamp);
  const scene::Scene scene = builder.take();
  EXPECT_NEAR(meanIrradiance(scene, quadAtlas(scene, 8, {0}), Component::direct, 256) / (0.199825 * kPi), 1, 0.005);
}

TEST(ClosedRoom, APointLightsPowerIsAbsorbedByTheWalls) {
  scene::Scene scene = closedBox(Vec3(1), diffuse(0.7f));
  scene.lights.push_back(pointLight(Vec3(0, 0.9f, 0), 1));
  const atlas::Atlas atlas = quadAtlas(scene, 16);
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::direct, 256) / (4 * kPi / 24), 1, 0.005);
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::total, 256) / (4 * kPi / 24 / 0.3), 1, 0.01);
}

TEST(ClosedRoom, ManyLightsGiveTheSumOfTheirPowers) {
  scene::Scene scene = closedBox(Vec3(5), diffuse(0.5f));
  double power = 0;
  for (int i = 0; i < 300; ++i) {  // more than are looked at one by one
    const Vec2 u = Sampler(3, i).get2D(0, 0);
    const float intensity = 0.1f + Sampler(3, i).get1D(0, 1) * (i % 50 == 0 ? 100.0f : 1.0f);
    scene.lights.push_back(pointLight(Vec3(8 * u.x - 4, 8 * Sampler(3, i).get1D(0, 2) - 4, 8 * u.y - 4), intensity));
    power += 4 * kPi * double(intensity);
  }
  const atlas::Atlas atlas = quadAtlas(scene, 8);
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::direct, 512) / (power / 600), 1, 0.01);
  EXPECT_NEAR(meanIrradiance(scene, atlas, Component::total, 512) / (power / 600 / 0.5), 1, 0.01);
}

/// A room of dim walls with a small lamp, a point light and a screen between.
scene::Scene furnishedRoom() {
  SceneBuilder builder;
  scene::Material red = diffuse(0.6f);
  red.base_color = Rgb(0.8f, 0.3f, 0.1f);
  scene::Material screen = diffuse(0.4f);
  screen.double_sided = true;
  builder.room(Vec3(-5), Vec3(5), builder.material(red));
  builder.quad(Vec3(-1, 4.5f, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), builder.material(diffuse(0.3f, 5)));
  builder.quad(Vec3(-2, -4, 1), Vec3(4, 0, 1), Vec3(0, 3, 0), builder.material(screen));
  scene::Scene scene = builder.take();
  scene.lights.push_back(pointLight(Vec3(3, -2, 3), 20));
  return scene;
}

TEST(Components, DirectAndIndirectAddUpToTotal) {
  const scene::Scene scene = furnishedRoom();
  const atlas::Atlas atlas = quadAtlas(scene, 4);
  const IrradianceMap direct = render(scene, atlas, Component::direct, 64), indirect = render(scene, atlas, Component::indirect, 64),
                      total = render(scene, atlas, Component::total, 64);
  for (size_t i = 0; i < total.irradiance_rgb.size(); ++i)  // the same random numbers: equal but for rounding
    for (int c = 0; c < 3; ++c) {
      const float sum = direct.irradiance_rgb[i][c] + indirect.irradiance_rgb[i][c];
      EXPECT_NEAR(sum / total.irradiance_rgb[i][c], 1, 1e-4);
    }
}

TEST(Components, ReciprocityHoldsBetweenTwoEmitters) {
  // Exchange: what quad a sends to b per unit radiance equals what b sends to a, through any number of reflections.
  const auto received = [](bool first_emits) {
    SceneBuilder builder;
    const uint32_t wall = builder.material(diffuse(0.6f));
    const uint32_t lamp = builder.material(diffuse(0.6f, 1)), dark = builder.material(diffuse(0.6f));
    builder.room(Vec3(-5), Vec3(5), wall);
    builder.quad(Vec3(-4, -4.9f, -4), Vec3(0, 0, 2), Vec3(1, 0, 0), first_emits ? lamp : dark);
    builder.quad(Vec3(4.8f, -2, 0), Vec3(0, 0, 4), Vec3(0, 3, 0), first_emits ? dark : lamp);
    const scene::Scene scene = builder.take();
    const atlas::Atlas atlas = quadAtlas(scene, 4, {first_emits ? 7u : 6u});
    const double area = first_emits ? 12 : 2;
    return meanIrradiance(scene, atlas, Component::indirect, 16384) * area;
  };
  EXPECT_NEAR(received(true) / received(false), 1, 0.02);
}

TEST(Lights, APointLightFollowsTheInverseSquareAndTheCosine) {
  SceneBuilder builder;
  builder.quad(Vec3(-4, 0, -4), Vec3(0, 0, 8), Vec3(8, 0, 0), builder.material(diffuse(0.5f)));
  scene::Scene scene = builder.take();
  scene.lights.push_back(pointLight(Vec3(1, 2, 0.5f), 10));
  const atlas::Atlas atlas = quadAtlas(scene, 32);
  const IrradianceMap map = render(scene, atlas, Component::total, 64);
  for (size_t i = 0; i < atlas.slots.size(); ++i) {
    const Vec3 to = scene.lights[0].position - atlas.slots[i].position;
    EXPECT_NEAR(map.irradiance_rgb[i].x * std::pow(to.length(), 3) / (10 * 2), 1, 0.025);  // a texel's mean is not quite its middle's value
  }
}

TEST(Lights, ASpotLightsOnlyItsConeAndADirectionalOneShinesParallel) {
  SceneBuilder builder;
  builder.quad(Vec3(-4, 0, -4), Vec3(0, 0, 8), Vec3(8, 0, 0), builder.material(diffuse(0.5f)));
  scene::Scene scene = builder.take();
  const atlas::Atlas atlas = quadAtlas(scene, 32);
  scene::Light spot = pointLight(Vec3(0, 3, 0), 9);
  spot.type = scene::LightType::spot;
  spot.inner_cone_angle = 0.2f, spot.outer_cone_angle = 0.5f;
  scene.lights = {spot};
  const IrradianceMap cone = render(scene, atlas, Component::direct, 16);
  for (size_t i = 0; i < atlas.slots.size(); ++i) {
    const float radius = std::hypot(atlas.slots[i].position.x, atlas.slots[i].position.z);
    if (radius > 3 * std::tan(0.5f) + 0.2f) { EXPECT_EQ(cone.irradiance_rgb[i].x, 0); }
    if (radius < 0.3f) { EXPECT_NEAR(cone.irradiance_rgb[i].x, 1, 0.05); }
  }
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.direction = Vec3(0.6f, -0.8f, 0);
  sun.intensity = Rgb(1000);
  scene.lights = {sun};
  for (const Rgb& e : render(scene, atlas, Component::total, 4).irradiance_rgb) EXPECT_NEAR(e.x, 800, 0.01);
  scene.lights[0].direction = Vec3(0, 1, 0);  // from below
  for (const Rgb& e : render(scene, atlas, Component::total, 4).irradiance_rgb) EXPECT_EQ(e.x, 0);
}

TEST(Lights, AShadowIsWhereGeometrySays) {
  SceneBuilder builder;
  const uint32_t grey = builder.material(diffuse(0.5f));
  builder.quad(Vec3(-4, 0, -4), Vec3(0, 0, 8), Vec3(8, 0, 0), grey);
  builder.quad(Vec3(-1, 1, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), grey);  // faces down; occludes from both sides
  scene::Scene scene = builder.take();
  scene.lights.push_back(pointLight(Vec3(0, 2, 0), 1));
  const atlas::Atlas atlas = quadAtlas(scene, 32, {0});
  const IrradianceMap map = render(scene, atlas, Component::direct, 16);
  for (size_t i = 0; i < atlas.slots.size(); ++i) {
    const float reach = std::max(std::abs(atlas.slots[i].position.x), std::abs(atlas.slots[i].position.z));
    if (reach < 1.8f) { EXPECT_EQ(map.irradiance_rgb[i].x, 0); }
    if (reach > 2.2f) { EXPECT_GT(map.irradiance_rgb[i].x, 0); }
  }
}

/// A floor under a ceiling-high emitter that faces up or down.
double floorUnderPanel(bool faces_down, bool double_sided) {
  SceneBuilder builder;
  scene::Material panel = diffuse(0, 1);
  panel.double_sided = double_sided;
  builder.quad(Vec3(-0.5f, 0, -0.5f), Vec3(0, 0, 1), Vec3(1, 0, 0), builder.material(diffuse(0)));
  const Vec3 x(1, 0, 0), z(0, 0, 1);
  builder.quad(Vec3(-0.5f, 1, -0.5f), faces_down ? x : z, faces_down ? z : x, builder.material(panel));
  const scene::Scene scene = builder.take();
  return meanIrradiance(scene, quadAtlas(scene, 4, {0}), Component::total, 256) / (0.199825 * kPi);
}

TEST(Sides, ASingleSidedEmitterShinesFromItsFrontOnly) {
  EXPECT_NEAR(floorUnderPanel(true, false), 1, 0.01);
  EXPECT_EQ(floorUnderPanel(false, false), 0);
  EXPECT_NEAR(floorUnderPanel(true, true), 1, 0.01);
  EXPECT_NEAR(floorUnderPanel(false, true), 1, 0.01);
}

TEST(Sides, OnlyTheFrontOfASingleSidedWallReflects) {
  const auto bounced = [](bool faces_light, bool double_sided) {
    SceneBuilder builder;
    scene::Material wall = diffuse(0.8f);
    wall.double_sided = double_sided;
    builder.quad(Vec3(0, 0, -1), Vec3(0, 0, 2), Vec3(2, 0, 0), builder.material(diffuse(0)));
    const Vec3 y(0, 2, 0), z(0, 0, 2);
    builder.quad(Vec3(0, 0, -1), faces_light ? y : z, faces_light ? z : y, builder.material(wall));
    scene::Scene scene = builder.take();
    scene.lights.push_back(pointLight(Vec3(1, 1, 0), 1));
    return meanIrradiance(scene, quadAtlas(scene, 4, {0}), Component::indirect, 1024);
  };
  const double front = bounced(true, false);
  EXPECT_GT(front, 0.01);
  EXPECT_EQ(bounced(false, false), 0);
  EXPECT_NEAR(bounced(false, true) / front, 1, 0.01);
  EXPECT_NEAR(bounced(true, true) / front, 1, 0.01);
}

TEST(Blend, AVeilTransmitsReflectsAndEmitsByItsAlpha) {
  // A black floor under an infinite-like emitter seen through a veil of alpha 0.25 that itself emits 2.
  SceneBuilder builder;
  scene::Material veil = diffuse(0, 2);
  veil.alpha_mode = scene::AlphaMode::blend;
  veil.alpha = 0.25f;
  builder.quad(Vec3(-0.5f, 0, -0.5f), Vec3(0, 0, 1), Vec3(1, 0, 0), builder.material(diffuse(0)));
  builder.quad(Vec3(-500, 2, -500), Vec3(1000, 0, 0), Vec3(0, 0, 1000), builder.material(diffuse(0, 1)));
  builder.quad(Vec3(-500, 1, -500), Vec3(1000, 0, 0), Vec3(0, 0, 1000), builder.material(veil));
  const scene::Scene scene = builder.take();
  const double mean = meanIrradiance(scene, quadAtlas(scene, 4, {0}), Component::direct, 4096);
  EXPECT_NEAR(mean / (kPi * (0.75 * 1 + 0.25 * 2)), 1, 0.01);
}

TEST(ShadingNormals, LightFromBelowTheGeometricSurfaceIsNotReceived) {
  SceneBuilder builder;
  builder.quad(Vec3(-1, 0, -1), Vec3(0, 0, 2), Vec3(2, 0, 0), builder.material(diffuse(0.5f)));
  scene::Scene scene = builder.take();
  const Vec3 tilted = Vec3(1, 0.2f, 0).normalized();
  for (Vec3& n : scene.mesh.normals) n = tilted;
  const atlas::Atlas atlas = quadAtlas(scene, 4);
  scene::Light sun;
  sun.type = scene::LightType::directional;
  sun.intensity = Rgb(1);
  sun.direction = Vec3(-0.9f, 0.1f, 0).normalized();  // rises from below the floor, yet faces the tilted normal
  scene.lights = {sun};
  for (const Rgb& e : render(scene, atlas, Component::total, 4).irradiance_rgb) EXPECT_EQ(e.x, 0);
  scene.lights[0].direction = -tilted;
  for (const Rgb& e : render(scene, atlas, Component::total, 4).irradiance_rgb) EXPECT_NEAR(e.x, 1, 1e-4);
}

}  // namespace
}  // namespace lightwell::transport
