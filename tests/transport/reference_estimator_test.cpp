// The reference as an estimator: reproducible, with honest errors, and with densities that are what they claim.
#include <gtest/gtest.h>

#include "precompute/core/error.h"
#include "precompute/core/random.h"
#include "precompute/transport/reference/emitters.h"
#include "precompute/transport/reference/punctual.h"
#include "precompute/transport/reference/reference.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

using test::diffuse;
using test::pointLight;
using test::quadAtlas;
using test::SceneBuilder;

scene::Scene lampRoom() {
  SceneBuilder builder;
  builder.room(Vec3(-5), Vec3(5), builder.material(diffuse(0.6f)));
  builder.quad(Vec3(-1, 4.5f, -1), Vec3(2, 0, 0), Vec3(0, 0, 2), builder.material(diffuse(0.3f, 5)));
  scene::Material veil = diffuse(0.5f);
  veil.alpha_mode = scene::AlphaMode::blend;
  veil.alpha = 0.5f;
  veil.double_sided = true;
  builder.quad(Vec3(-2, -4, 1), Vec3(4, 0, 1), Vec3(0, 3, 0), builder.material(veil));
  scene::Scene scene = builder.take();
  scene.lights = {pointLight(Vec3(3, -2, 3), 20), pointLight(Vec3(-3, 2, 3), 5)};
  return scene;
}

TEST(Reference, IsTheSameForAnyThreadsAndAnySplitIntoRanges) {
  const scene::Scene scene = lampRoom();
  const atlas::Atlas atlas = quadAtlas(scene, 8);
  const trace::Tracer tracer(scene);
  for (const uint32_t samples : {3u, 100u}) {
    ReferenceOptions options;
    options.samples = samples;
    options.threads = 1;
    const IrradianceMap expected = referenceIrradiance(scene, atlas, tracer, scene.lights, Component::total, options);
    options.threads = 3;
    const IrradianceMap threaded = referenceIrradiance(scene, atlas, trace::Tracer(scene, 2), scene.lights, Component::total, options);
    EXPECT_EQ(threaded.irradiance_rgb, expected.irradiance_rgb);
    EXPECT_EQ(threaded.standard_error_rgb, expected.standard_error_rgb);
    IrradianceMap joined;
    for (size_t first = 0; first < atlas.slots.size(); first += 37) {
      const IrradianceMap part = referenceIrradianceRange(scene, atlas, tracer, scene.lights, Component::total, options, first,
                                                          std::min(first + 37, atlas.slots.size()));
      joined.irradiance_rgb.insert(joined.irradiance_rgb.end(), part.irradiance_rgb.begin(), part.irradiance_rgb.end());
    }
    EXPECT_EQ(joined.irradiance_rgb, expected.irradiance_rgb);
    const std::vector<uint32_t> chosen{41, 3, 40};
    const IrradianceMap few = referenceIrradianceOf(chosen, scene, atlas, tracer, scene.lights, Component::total, options);
    ASSERT_EQ(few.irradiance_rgb.size(), chosen.size());
    for (size_t i = 0; i < chosen.size(); ++i) EXPECT_EQ(few.irradiance_rgb[i], expected.irradiance_rgb[chosen[i]]);
    options.seed = 2;
    EXPECT_NE(referenceIrradiance(scene, atlas, tracer, scene.lights, Component::total, options).irradiance_rgb, expected.irradiance_rgb);
  }
}

TEST(Reference, StandardErrorsAreHonest) {
  const scene::Scene scene = lampRoom();
  const atlas::Atlas atlas = quadAtlas(scene, 4);
  const trace::Tracer tracer(scene);
  for (const uint32_t samples : {16u, 128u}) {
    // Two independent maps differ by a variance that is the sum of theirs.
    ReferenceOptions options;
    options.samples = samples;
    double difference2 = 0, claimed2 = 0;
    for (uint64_t pair = 0; pair < 12; ++pair) {
      options.seed = 100 + 2 * pair;
      const IrradianceMap a = referenceIrradiance(scene, atlas, tracer, scene.lights, Component::total, options);
      options.seed = 101 + 2 * pair;
      const IrradianceMap b = referenceIrradiance(scene, atlas, tracer, scene.lights, Component::total, options);
      for (size_t i = 0; i < a.irradiance_rgb.size(); ++i) {
        difference2 += std::pow(a.irradiance_rgb[i].x - b.irradiance_rgb[i].x, 2);
        claimed2 += std::pow(a.standard_error_rgb[i].x, 2) + std::pow(b.standard_error_rgb[i].x, 2);
      }
    }
    EXPECT_NEAR(std::sqrt(claimed2 / difference2), 1, 0.1) << samples;
  }
}

TEST(Reference, ErrorFallsWithSamples) {
  const scene::Scene scene = lampRoom();
  const atlas::Atlas atlas = quadAtlas(scene, 4);
  const trace::Tracer tracer(scene);
  const auto meanError = [&](uint32_t samples) {
    ReferenceOptions options;
    options.samples = samples;
    const IrradianceMap map = referenceIrradiance(scene, atlas, tracer, scene.lights, Component::total, options);
    double sum = 0;
    for (const Rgb& error : map.standard_error_rgb) sum += error.x;
    return sum;
  };
  EXPECT_LT(meanError(1024), meanError(64) / 3.5);  // at least the square root of 16, within noise
}

TEST(Reference, RejectsNoSamplesAndStopsWhenCancelled) {
  const scene::Scene scene = lampRoom();
  const atlas::Atlas atlas = quadAtlas(scene, 2);
  const trace::Tracer tracer(scene);
  ReferenceOptions options;
  options.samples = 0;
  EXPECT_THROW(referenceIrradiance(scene, atlas, tracer, scene.lights, Component::total, options), UsageError);
  CancelFlag cancel;
  options.samples = 8192;  // a piece of work is one texel
  options.cancel = &cancel;
  options.progress = [&](double) { cancel.cancel(); };
  EXPECT_THROW(referenceIrradiance(scene, atlas, tracer, scene.lights, Component::total, options), Cancelled);
}

TEST(LightTree, PicksWithTheProbabilityItClaims) {
  std::vector<LightBounds> items(40);
  for (uint32_t i = 0; i < items.size(); ++i) {
    const Vec2 u = Sampler(1, i).get2D(0, 0);
    items[i].box = Box3(Vec3(10 * u.x - 5, 2, 10 * u.y - 5));
    items[i].box.extendBy(items[i].box.min + Vec3(0.3f * u.y, 0, 0.2f));
    items[i].axis = Vec3(0, i % 3 ? -1 : 1, 0);
    items[i].emission_spread = kPi / 2;
    items[i].two_sided = i % 5 == 0;
    items[i].power = i == 7 ? 0 : 0.1f + u.x;
  }
  const LightTree tree(items);
  for (const Vec3& position : {Vec3(0, 0, 0), Vec3(4, 1.9f, -4), Vec3(0, 3, 0)}) {
    const Vec3 normal = Vec3(0.2f, position.y > 2 ? -1 : 1, 0).normalized();
    constexpr int kPicks = 200000;
    std::vector<double> share(items.size());
    for (int i = 0; i < kPicks; ++i) {
      const LightTree::Pick pick = tree.pick(position, normal, (i + 0.5f) / kPicks);
      if (pick.item == kNone) continue;
      share[pick.item] += 1.0 / kPicks;
      ASSERT_NEAR(pick.probability, tree.probability(pick.item, position, normal), 1e-5f);
    }
    for (uint32_t i = 0; i < items.size(); ++i) {
      EXPECT_NEAR(share[i], tree.probability(i, position, normal), 2e-4) << i;
      // What faces the point and lies on the receiving side must have a chance.
      const Vec3 to = items[i].box.center() - position;
      if (items[i].power > 0 && to.dot(normal) > 0 && -to.dot(items[i].axis) > 0) {
        EXPECT_GT(tree.probability(i, position, normal), 0) << i;
      }
    }
    EXPECT_EQ(tree.probability(7, position, normal), 0);
  }
}

TEST(LightTree, SurvivesCoincidentLights) {
  std::vector<LightBounds> items(10000);
  for (LightBounds& item : items) {
    item.box = Box3(Vec3(1, 2, 3));
    item.normal_spread = kPi, item.emission_spread = kPi / 2;
    item.power = 1;
  }
  const LightTree tree(items);
  EXPECT_NEAR(tree.probability(1234, Vec3(0, 0, 0), Vec3(0, 1, 0)), 1e-4, 1e-6);
  EXPECT_NE(tree.pick(Vec3(1, 2, 3), Vec3(0, 1, 0), 0.3f).item, kNone);  // from the lights' own place
}

TEST(PunctualLights, ManyAndFewEstimateTheExactSum) {
  for (const int count : {5, 100}) {
    std::vector<scene::Light> lights;
    for (int i = 0; i < count; ++i) {
      const Vec2 u = Sampler(9, i).get2D(0, 0);
      scene::Light light = pointLight(Vec3(10 * u.x - 5, 1 + 3 * u.y, 10 * Sampler(9, i).get1D(0, 1) - 5), 1 + 10 * u.y);
      if (i % 3 == 1) light.type = scene::LightType::spot, light.inner_cone_angle = 0.3f, light.outer_cone_angle = 1.0f;
      if (i % 4 == 3) light.type = scene::LightType::directional, light.intensity = Rgb(0.3f);
      lights.push_back(light);
    }
    const PunctualLights punctual(lights);
    const Vec3 position(0.5f, 0, 0.2f), normal(0, 1, 0);
    double expected = 0;
    Vec3 to;
    float distance;
    for (const scene::Light& light : lights) expected += scene::lightIrradiance(light, position, normal, to, distance).x;
    for (const bool all_of_few : {true, false}) {
      double sum = 0;
      constexpr int kDraws = 100000;
      std::vector<PunctualLights::Sample> samples;
      for (int i = 0; i < kDraws; ++i) {
        samples.clear();
        punctual.sample(position, normal, all_of_few, (i + 0.5f) / kDraws, samples);
        for (const auto& sample : samples) sum += sample.irradiance_rgb.x;
        ASSERT_LE(samples.size(), all_of_few && count == 5 ? 5u : 2u);
      }
      EXPECT_NEAR(sum / kDraws / expected, 1, 2e-3) << count << " lights";
    }
  }
}

/// One large wall whose emission is a texture: a lit corner of 1/16 of its area, half as bright as the factor, the rest dark.
scene::Scene paintedWall() {
  SceneBuilder builder;
  scene::Material wall = diffuse(0, 4);
  wall.emissive_texture = 0;
  builder.quad(Vec3(-0.5f, 0, -0.5f), Vec3(0, 0, 1), Vec3(1, 0, 0), builder.material(diffuse(0)));
  builder.quad(Vec3(-4, 3, -4), Vec3(8, 0, 0), Vec3(0, 0, 8), builder.material(wall));
  scene::Scene scene = builder.take();
  scene::Texture texture;
  texture.width = texture.height = 64;
  for (int i = 0; i < 64 * 64; ++i) {
    const uint8_t lit = i % 64 < 16 && i / 64 < 16 ? 255 : 0;
    texture.rgba.insert(texture.rgba.end(), {lit, lit, lit, 255});
  }
  texture.wrap_u = texture.wrap_v = scene::Texture::Wrap::clamp;
  scene.textures.push_back(texture);
  return scene;
}

TEST(Emitters, DensityIntegratesToOneAndMatchesTheSamples) {
  const scene::Scene scene = paintedWall();
  const Emitters emitters(scene);
  const Vec3 position(0.3f, 0, 0.1f), normal(0, 1, 0);
  // ∫ pdf dA over the wall by midpoints; both triangles have half of its 64 units².
  constexpr int kGrid = 256;
  double integral = 0;
  for (uint32_t triangle = 0; triangle < 4; ++triangle)
    for (int j = 0; j < kGrid; ++j)
      for (int i = 0; i + j < kGrid; ++i) {
        const bool diagonal = i + j == kGrid - 1;
        const float shift = diagonal ? 1.0f / 3 : 0.5f;
        const float pdf_area = emitters.pdfArea(triangle, (i + shift) / kGrid, (j + shift) / kGrid, position, normal);
        integral += pdf_area * (diagonal ? 32.0 : 64.0) / (kGrid * kGrid);
      }
  EXPECT_NEAR(integral, 1, 0.01);

  int lit = 0;
  constexpr int kDraws = 4096;
  for (int i = 0; i < kDraws; ++i) {
    const Sampler sampler(5, 6);
    const auto sample = emitters.sample(position, normal, sampler.get1D(i, 0), sampler.get2D(i, 0));
    ASSERT_TRUE(sample);
    ASSERT_FLOAT_EQ(sample->position.y, 3);
    ASSERT_LT(sample->geometric_normal.y, 0);
    lit += sample->radiance_rgb.x > 0;
  }
  EXPECT_GT(lit, kDraws * 85 / 100);  // by plain area it would be one in sixteen
}

TEST(Emitters, PaintedLampsAreEstimatedWithoutBias) {
  // The lit corner as a quad of its own must give the same light. Bilinear filtering blurs its edge by half a texel each way: no net
  // change.
  const scene::Scene painted = paintedWall();
  SceneBuilder builder;
  builder.quad(Vec3(-0.5f, 0, -0.5f), Vec3(0, 0, 1), Vec3(1, 0, 0), builder.material(diffuse(0)));
  builder.quad(Vec3(-4, 3, -4), Vec3(2, 0, 0), Vec3(0, 0, 2), builder.material(diffuse(0, 4)));
  const scene::Scene separate = builder.take();
  const auto mean = [](const scene::Scene& scene) {
    const atlas::Atlas atlas = quadAtlas(scene, 4, {0});
    ReferenceOptions options;
    options.samples = 1024;
    return test::meanOverArea(
        atlas, referenceIrradiance(scene, atlas, trace::Tracer(scene), {}, Component::direct, options).irradiance_rgb);
  };
  EXPECT_NEAR(mean(painted) / mean(separate), 1, 0.02);
}

}  // namespace
}  // namespace lightwell::transport
