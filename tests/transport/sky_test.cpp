// The sky as a light of the path tracer, against what is known in closed form.
#include <gtest/gtest.h>

#include "precompute/core/random.h"
#include "precompute/transport/environment/exact_environment.h"
#include "precompute/transport/environment/sky_light.h"
#include "precompute/transport/reference/reference.h"
#include "tests/environment/skies.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

using test::diffuse;
using test::meanOverArea;
using test::quadAtlas;
using test::SceneBuilder;

SkyGrid gridOf(EnvironmentMap map) {
  Diagnostics diagnostics;
  return makeSkyGrid(map, 2048, diagnostics, nullptr);
}
SkyLight skyOf(int width, const std::function<Rgb(const Vec3&)>& radiance, const MapPlacement& placement = {}) {
  return SkyLight(gridOf(makeSky(width, width / 2, radiance, placement)));
}
IrradianceMap render(const scene::Scene& scene, const atlas::Atlas& atlas, const SkyLight& sky, Component component, uint32_t samples) {
  const trace::Tracer tracer(scene);
  ReferenceOptions options{.samples = samples};
  options.sky = &sky;
  return referenceIrradiance(scene, atlas, tracer, scene.lights, component, options);
}
double meanIrradiance(const scene::Scene& scene, const atlas::Atlas& atlas, const SkyLight& sky, Component component, uint32_t samples) {
  return meanOverArea(atlas, render(scene, atlas, sky, component, samples).irradiance_rgb);
}
Rgb white(const Vec3&) { return Rgb(1); }
scene::Scene floorOf(float albedo) {
  SceneBuilder builder;
  builder.quad(Vec3(-1, 0, -1), Vec3(0, 0, 2), Vec3(2, 0, 0), builder.material(diffuse(albedo)));  // faces up
  return builder.take();
}

TEST(SkyLight, SamplesFollowTheDensityAndCarryTheWholeFlux) {
  MapPlacement tilted;
  tilted.world_from_map = rotationAboutY(1.2) * Imath::M33d(1, 0, 0, 0, 0.8, -0.6, 0, 0.6, 0.8);
  const SkyGrid grid = gridOf(makeSky(256, 128, outdoorRadiance, tilted));
  const SkyLight sky(grid);
  double flux = 0, up = 0;
  for (size_t i = 0; i < grid.size(); ++i) flux += luminance(grid.flux_rgb[i]), up += luminance(grid.flux_rgb[i]) * grid.direction[i].y;
  const Sampler sampler(3, 5);
  constexpr uint32_t kSamples = 1 << 14;
  double estimate = 0, estimated_up = 0;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const SkyLight::Sample sample = sky.sample(sampler.get2D(i, 0));
    ASSERT_GT(sample.pdf_solid_angle, 0);
    ASSERT_NEAR(sample.direction.length(), 1, 1e-5);
    const SkyLight::Value value = sky.at(sample.direction);
    if (value.radiance_rgb != sample.radiance_rgb) continue;  // on an edge between cells, rounding may fall to either side
    EXPECT_EQ(value.pdf_solid_angle, sample.pdf_solid_angle);
    estimate += luminance(sample.radiance_rgb) / sample.pdf_solid_angle / kSamples;
    estimated_up += luminance(sample.radiance_rgb) / sample.pdf_solid_angle * sample.direction.y / kSamples;
  }
  EXPECT_NEAR(estimate / flux, 1, 1e-3);  // each sample carries the same luminance
  EXPECT_NEAR(estimated_up / flux, up / flux, 3e-3);
  // The density integrates to one.
  double integral = 0;
  const Sampler uniform(9, 1);
  const SkyLight smooth = skyOf(64, [](const Vec3& d) { return Rgb(1.5f + d.x); });
  for (uint32_t i = 0; i < kSamples; ++i) integral += smooth.at(uniformDirection(uniform.get2D(i, 0))).pdf_solid_angle * 4 * kPi / kSamples;
  EXPECT_NEAR(integral, 1, 1e-3);
}

TEST(Sky, AnOpenPlaneUnderAConstantSkyReceivesPi) {
  const scene::Scene scene = floorOf(0.7f);
  const atlas::Atlas atlas = quadAtlas(scene, 8);
  const SkyLight sky = skyOf(64, white);
  for (const Component component : {Component::direct, Component::total}) {
    const IrradianceMap map = render(scene, atlas, sky, component, 256);
    EXPECT_NEAR(meanOverArea(atlas, map.irradiance_rgb) / kPi, 1, 1e-3);
    for (const Rgb& e : map.irradiance_rgb) EXPECT_NEAR(e.x / kPi, 1, 0.1);
  }
  EXPECT_EQ(meanIrradiance(scene, atlas, sky, Component::indirect, 64), 0);
}

TEST(Sky, AClosedBoxReceivesNothing) {
  const scene::Scene scene = test::closedBox(Vec3(2), diffuse(0.5f));
  const atlas::Atlas atlas = quadAtlas(scene, 4);
  for (const Component component : {Component::direct, Component::indirect, Component::total})
    EXPECT_EQ(meanIrradiance(scene, atlas, skyOf(64, white), component, 64), 0);
}

/// A cap of radiance L and angular radius r around a direction d, all above the horizon, gives π L sin² r (d · n).
TEST(Sky, ACapGivesItsProjectedSolidAngle) {
  const scene::Scene scene = floorOf(0);
  const atlas::Atlas atlas = quadAtlas(scene, 2);
  const Vec3 center = Vec3(0.3f, 0.8f, -0.5f).normalized();
  for (const float radius_rad : {0.5f, 0.1f, 0.01f}) {  // the last is a sun, six texels wide
    const SkyLight sky = skyOf(2048, [&](const Vec3& d) { return Rgb(inCap(d, center, radius_rad)) / (radius_rad * radius_rad); });
    const double exact = kPi * std::pow(std::sin(radius_rad) / radius_rad, 2) * center.y;
    EXPECT_NEAR(meanIrradiance(scene, atlas, sky, Component::direct, 256) / exact, 1, radius_rad < 0.05f ? 0.03 : 0.005) << radius_rad;
  }
}

TEST(Sky, WhatShinesFromBelowIsNotReceived) {
  const scene::Scene scene = floorOf(0.5f);
  const SkyLight sky = skyOf(64, [](const Vec3& d) { return Rgb(d.y < 0 ? 1 : 0); });
  EXPECT_EQ(meanIrradiance(scene, quadAtlas(scene, 2), sky, Component::total, 256), 0);
}

/// An opening to a sky of radiance 1 is a black wall that emits 1.
TEST(Sky, AnOpeningIsAnEmitter) {
  const auto room = [](bool open) {
    SceneBuilder builder;
    const uint32_t wall = builder.material(diffuse(0.6f)), lamp = builder.material(diffuse(0, 1));
    const Vec3 x(2, 0, 0), y(0, 1, 0), z(0, 0, 2);
    builder.quad(Vec3(0), z, x, wall);
    builder.quad(Vec3(0), y, z, wall).quad(x, z, y, wall).quad(Vec3(0), x, y, wall).quad(z, y, x, wall);
    if (!open) builder.quad(y, x, z, lamp);
    return builder.take();
  };
  const scene::Scene open = room(true), closed = room(false);
  const atlas::Atlas open_atlas = quadAtlas(open, 4, {0, 1, 2, 3, 4}), closed_atlas = quadAtlas(closed, 4, {0, 1, 2, 3, 4});
  const SkyLight sky = skyOf(64, white), dark = skyOf(64, [](const Vec3&) { return Rgb(0); });
  for (const Component component : {Component::direct, Component::indirect, Component::total}) {
    const double from_sky = meanIrradiance(open, open_atlas, sky, component, 1024);
    const double from_lamp = meanIrradiance(closed, closed_atlas, dark, component, 1024);
    EXPECT_GT(from_lamp, 0.1);
    EXPECT_NEAR(from_sky / from_lamp, 1, 0.01) << int(component);
  }
}

TEST(Sky, ASunAMillionTimesItsSkyIsFoundAndUnbiased) {
  const Vec3 sun = Vec3(0.4f, 0.7f, 0.2f).normalized();
  EnvironmentMap map = makeSky(1024, 512, [&](const Vec3& d) { return Rgb(1) + Rgb(1e6f) * inCap(d, sun, 0.008f); });
  Diagnostics diagnostics;
  const double exact = exactAnswers(map, std::array{EnvironmentQuery{Vec3(0, 1, 0), 1}}, 1, diagnostics, nullptr)[0].x;
  const SkyLight sky(makeSkyGrid(map, 2048, diagnostics, nullptr));
  const scene::Scene scene = floorOf(0);
  const atlas::Atlas atlas = quadAtlas(scene, 4);
  const IrradianceMap traced = render(scene, atlas, sky, Component::direct, 4096);
  EXPECT_NEAR(meanOverArea(atlas, traced.irradiance_rgb) / exact, 1, 2e-3);  // noise: 0.05 %
  for (const Rgb& e : traced.irradiance_rgb) EXPECT_NEAR(e.x / exact, 1, 0.02);
}

}  // namespace
}  // namespace lightwell::transport
