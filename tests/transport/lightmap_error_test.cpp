// What a light map says about its own error; what it gives to tilted normals; that more work makes it better.
#include <gtest/gtest.h>

#include <cstdlib>

#include "precompute/transport/measured_texels.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/reference/reference.h"
#include "tests/transport/baked_lightmap.h"

namespace lightwell::transport {
namespace {

std::vector<std::vector<Rgb>> references(const Prepared& p, Component component, uint32_t samples) {
  std::vector<std::vector<Rgb>> all;
  for (const uint64_t seed : {101u, 102u, 103u})
    all.push_back(referenceIrradiance(p.scene, p.atlas, *p.tracer, p.scene.lights, component, {.samples = samples, .seed = seed}).irradiance_rgb);
  return all;
}

std::vector<Rgb> total(const Lightmap& map) {
  std::vector<Rgb> sum = map.direct_rgb;
  for (size_t i = 0; i < sum.size(); ++i) sum[i] += map.indirect_rgb[i];
  return sum;
}

/// A lamp in a room, and a panel that emits.
scene::Scene litRoom() {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.6f)), panel = builder.material(test::diffuse(0.5f, 5.0f));
  builder.room({-2, 0, -2}, {2, 3, 2}, wall);
  builder.quad({-0.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, panel);
  const Vec3 low(-0.6f, 0, -0.4f), x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  builder.quad(low + y, z, x, wall).quad(low, z, y, wall).quad(low + x, y, z, wall).quad(low, y, x, wall).quad(low + z, x, y, wall);
  scene::Scene scene = builder.take();
  scene.lights.push_back(test::pointLight({1.2f, 2.0f, 0.9f}, 4.0f));
  return scene;
}

LightmapSettings draft() {
  LightmapSettings settings;
  settings.direct.most_samples = 64, settings.direct.error = 0.06f, settings.patches.most = 1000;
  settings.cache_rays = 64, settings.first_gather_rays = 8, settings.gather_rays = 16;
  return settings;
}

/// LIGHTWELL_SEEDS bakes, each with its own seed and its own measurement: how many intervals hold the true error.
TEST(LightmapError, MeasuredIntervalsHoldTheTrueError) {
  const char* asked = std::getenv("LIGHTWELL_SEEDS");
  const int seeds = asked ? std::atoi(asked) : 3;
  const Prepared p(litRoom(), 48);
  const auto truth = references(p, Component::total, seeds > 3 ? 2048 : 256);
  int relrmse_held = 0, texrel_held = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    LightmapSettings settings = draft();
    settings.seed = uint64_t(seed);
    PooledError measured;
    const Lightmap map = bake(p, settings, 200, 2, &measured);
    const PooledError is = compareWithReferences(truth, total(map));
    ASSERT_GT(measured.texels, 500u);
    EXPECT_LE(measured.relrmse_95.low, measured.relrmse);
    EXPECT_LE(measured.relrmse, measured.relrmse_95.high);
    EXPECT_LT(measured.relrmse_95.high, 0.3) << "an interval that says nothing holds everything";
    EXPECT_NEAR(measured.bias, is.bias, 0.03);
    relrmse_held += measured.relrmse_95.low <= is.relrmse && is.relrmse <= measured.relrmse_95.high;
    texrel_held += measured.texrel_95.low <= is.texrel && is.texrel <= measured.texrel_95.high;
    if (seeds > 3)
      std::printf("seed %d: relrmse %.4f in [%.4f, %.4f], texrel %.4f in [%.4f, %.4f]\n", seed, is.relrmse, measured.relrmse_95.low, measured.relrmse_95.high, is.texrel,
                  measured.texrel_95.low, measured.texrel_95.high);
  }
  EXPECT_GE(relrmse_held, seeds > 3 ? 0.9 * seeds : seeds - 1);
  EXPECT_GE(texrel_held, seeds > 3 ? 0.9 * seeds : seeds - 1);
}

TEST(LightmapError, ChosenTexelsStandForAll) {
  std::vector<uint32_t> density(5000, 10);
  for (size_t i = 0; i < 100; ++i) density[i * 50] = 160;
  double counted = 0, bright = 0;
  for (uint64_t seed = 1; seed <= 50; ++seed) {
    const MeasuredTexels chosen = chooseTexels(density, 400, seed);
    EXPECT_TRUE(std::is_sorted(chosen.slot.begin(), chosen.slot.end()));
    for (size_t i = 0; i < chosen.slot.size(); ++i) {
      counted += double(chosen.weight[i]) / 50;
      if (density[chosen.slot[i]] > 10) bright += double(chosen.weight[i]) / 50;
    }
  }
  EXPECT_NEAR(counted, 5000, 100);
  EXPECT_NEAR(bright, 100, 10);
  EXPECT_EQ(chooseTexels(density, 6000, 1).slot.size(), 5000u);
}

TEST(LightmapError, FallsWithTheWork) {
  const Prepared p(litRoom(), 32);
  const auto truth = references(p, Component::total, 512);
  double before = 1;
  for (const uint32_t step : {1u, 4u, 16u}) {
    LightmapSettings settings = draft();
    settings.gather_rays *= step, settings.first_gather_rays *= step, settings.direct.most_samples *= step;
    settings.direct.error /= std::sqrt(float(step));
    const double error = compareWithReferences(truth, total(bake(p, settings))).relrmse;
    EXPECT_LT(error, before * 1.05) << step;
    before = error;
  }
  EXPECT_LT(before, 0.03);
}

/// A floor of two charts side by side: where they meet, light differs by no more than between neighbours in one of them.
TEST(LightmapSeams, AreNoLargerThanStepsWithinCharts) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.6f)), panel = builder.material(test::diffuse(0.5f, 5.0f));
  builder.room({-2, 0, -2}, {2, 3, 2}, wall);
  builder.quad({-2, 0.2f, -2}, {0, 0, 4}, {2, 0, 0}, wall).quad({0, 0.2f, -2}, {0, 0, 4}, {2, 0, 0}, wall);  // quads 6 and 7 hide the floor
  builder.quad({-0.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, panel);
  scene::Scene scene = builder.take();
  scene.lights.push_back(test::pointLight({1.2f, 2.0f, 0.9f}, 4.0f));
  const Prepared p(std::move(scene), 128);
  const auto irradiance_rgb = total(bake(p, LightmapSettings{}));
  const auto quadOf = [&](uint32_t slot) { return p.atlas.patches[p.atlas.slots[slot].first_patch].triangle / 2; };
  // Steps between slots as far from each other as neighbours are, within and across.
  const auto& slots = p.atlas.slots;
  double within = 0, across = 0, largest_within = 0, largest_across = 0;
  int count_within = 0, count_across = 0;
  for (uint32_t a = 0; a < slots.size(); ++a) {
    if (quadOf(a) != 6 || slots[a].position.x < -0.5f || std::abs(slots[a].position.z) > 1.8f) continue;
    const float width = std::sqrt(slots[a].area);
    for (uint32_t b = 0; b < slots.size(); ++b) {
      const uint32_t quad = quadOf(b);
      const Vec3 to = slots[b].position - slots[a].position;
      if ((quad != 6 && quad != 7) || a == b || to.length() > 1.3f * width || !(to.x > 0.5f * width)) continue;
      const double step = std::abs(luminance(irradiance_rgb[a]) - luminance(irradiance_rgb[b])) / luminance(irradiance_rgb[a]);
      if (quad == 6) within += step, ++count_within, largest_within = std::max(largest_within, step);
      else across += step, ++count_across, largest_across = std::max(largest_across, step);
    }
  }
  ASSERT_GT(count_within, 50);
  ASSERT_GT(count_across, 10);
  within /= count_within, across /= count_across;
  std::printf("mean step within charts %.2f %%, across a seam %.2f %%; largest %.2f %% and %.2f %%\n", 100 * within, 100 * across, 100 * largest_within, 100 * largest_across);
  EXPECT_LT(across, 1.5 * within + 0.003);
  EXPECT_LT(largest_across, 1.3 * largest_within);
}

/// Plates that reflect nothing hang in a room: their normals may be tilted without a change of the light around them.
TEST(DirectionalLightmap, GivesTiltedNormalsTheirLight) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.6f)), panel = builder.material(test::diffuse(0.5f, 5.0f)), black = builder.material(test::diffuse(0.0f));
  builder.room({-2, 0, -2}, {2, 3, 2}, wall);                                   // quads 0 to 5
  builder.quad({-0.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, panel);              // 6, shines down
  builder.quad({-1.5f, 1, -1.5f}, {0, 0, 1}, {1, 0, 0}, black);                 // 7 and on: up, along x, along z
  builder.quad({-1.6f, 0.5f, 0.4f}, {0, 1, 0}, {0, 0, 1}, black).quad({0.3f, 0.5f, -1.6f}, {1, 0, 0}, {0, 1, 0}, black);
  scene::Scene scene = builder.take();
  scene.lights.push_back(test::pointLight({1.2f, 2.0f, 0.9f}, 4.0f));
  const Prepared p(std::move(scene), 64);
  LightmapSettings settings;
  settings.directional = true;
  const Lightmap map = bake(p, settings);
  ASSERT_EQ(map.direct_gradient.size(), p.atlas.slots.size());
  for (const float degrees : {15.0f, 30.0f, 45.0f}) {
    const float angle = degrees * kPi / 180;
    double flat_square = 0, square = 0, reference_square = 0;
    for (int turn = 0; turn < 3; ++turn) {
      // All normals of a plate alike, each plate another way.
      scene::Scene tilted = p.scene;
      std::vector<Vec3> normal_of_triangle(tilted.mesh.triangles.size(), Vec3(0.0f));
      for (uint32_t quad = 7; quad < 10; ++quad)
        for (uint32_t triangle = 2 * quad; triangle < 2 * quad + 2; ++triangle) {
          const Vec3 normal = p.scene.mesh.normals[p.scene.mesh.triangles[triangle][0]];
          Vec3 tangent, bitangent;
          orthonormalBasis(normal, tangent, bitangent);
          const float phi = 2.1f * float(turn) + float(quad);
          const Vec3 m = normal * std::cos(angle) + (tangent * std::cos(phi) + bitangent * std::sin(phi)) * std::sin(angle);
          normal_of_triangle[triangle] = m;
          for (const uint32_t vertex : {0, 1, 2}) tilted.mesh.normals[tilted.mesh.triangles[triangle][vertex]] = m;
        }
      const trace::Tracer tracer(tilted, 1);
      const auto normalOf = [&](uint32_t slot) { return normal_of_triangle[p.atlas.patches[p.atlas.slots[slot].first_patch].triangle]; };
      std::vector<uint32_t> plates;
      for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot)
        if (normalOf(slot) != Vec3(0.0f)) plates.push_back(slot);
      ASSERT_GT(plates.size(), 20u);
      const auto reference_rgb =
          referenceIrradianceOf(plates, tilted, p.atlas, tracer, tilted.lights, Component::total, {.samples = 512, .seed = uint64_t(turn) + 7}).irradiance_rgb;
      for (size_t i = 0; i < plates.size(); ++i) {
        const uint32_t slot = plates[i];
        const Vec3 m = normalOf(slot);
        const Vec3 tilt = m - p.atlas.slots[slot].normal;
        const auto about = [&](const Rgb& irradiance_rgb, const Vec3& gradient) { return irradiance_rgb * std::max(0.0f, 1 + gradient.dot(tilt)); };
        const Rgb given = about(map.direct_rgb[slot], map.direct_gradient[slot]) + about(map.indirect_rgb[slot], map.indirect_gradient[slot]);
        for (int c = 0; c < 3; ++c) {
          EXPECT_GE(given[c], 0.0f);
          square += std::pow(double(given[c] - reference_rgb[i][c]), 2.0);
          flat_square += std::pow(double(map.direct_rgb[slot][c] + map.indirect_rgb[slot][c] - reference_rgb[i][c]), 2.0);
          reference_square += std::pow(double(reference_rgb[i][c]), 2.0);
        }
      }
    }
    const double error = std::sqrt(square / reference_square), flat = std::sqrt(flat_square / reference_square);
    RecordProperty("relrmse_" + std::to_string(int(degrees)), std::to_string(error));
    std::printf("tilted by %2.0f degrees: relrmse %.1f %%, without gradients %.1f %%\n", double(degrees), 100 * error, 100 * flat);
    EXPECT_LT(error, degrees == 15 ? 0.05 : degrees == 30 ? 0.06 : 0.1);
    EXPECT_LT(error, 0.5 * flat);
  }
}

}  // namespace
}  // namespace lightwell::transport
