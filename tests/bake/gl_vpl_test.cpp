// Light maps from virtual lights on OpenGL against exact irradiance and rays on the CPU.
#include <algorithm>
#include <cstdio>
#include <random>

#include "tests/bake/gl_vpl_fixture.h"

namespace lightwell::bake {
namespace {

using GlVplRooms = GlVplTest;
INSTANTIATE_TEST_SUITE_P(Contexts, GlVplRooms, testing::Values(test::Api::desktop33, test::Api::embedded30), test::apiName);

/// Slots next to which the visible share of the light changes little: away from the borders of shadows.
std::vector<bool> awayFromBorders(const atlas::Atlas& atlas, const SlotLight& light) {
  std::vector<bool> away(atlas.slots.size(), true);
  for (size_t i = 0; i < atlas.slots.size(); ++i) {
    const int x = int(atlas.slots[i].texel) % atlas.width, y = int(atlas.slots[i].texel) / atlas.width;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, atlas.height - 1); ++v)
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, atlas.width - 1); ++u)
        if (const uint32_t other = atlas.texel_slot[size_t(v) * atlas.width + u]; other != kNone && atlas.slots[other].chart == atlas.slots[i].chart)
          if (std::abs(light.visible_share[other] - light.visible_share[i]) > 0.1) away[i] = false;
  }
  return away;
}

TEST_P(GlVplRooms, AgreeWithRaysAwayFromTheBordersOfShadows) {
  const struct {
    const char* name;
    scene::Scene (*make)();
  } rooms[] = {{"boxes in a box", boxesInBox}, {"two rooms", twoRooms}, {"columns", columns}};
  for (const auto& [name, make] : rooms) {
    if (GetParam() == test::Api::embedded30 && make != boxesInBox) continue;  // the shaders are the same: one is enough
    const LitRoom room(make(), 64, 200);
    const SlotLight traced = room.trace(32);
    const auto away = awayFromBorders(room.p.atlas, traced);
    lw_gl_vpl_options options = LW_GL_VPL_OPTIONS_INIT;
    options.pieces = 8;
    const auto drawn = draw(room, options);
    const double share = double(std::count(away.begin(), away.end(), true)) / double(away.size());
    const double error = relativeError(drawn, traced.irradiance_rgb, [&](size_t i) { return away[i]; });
    std::printf("%s: %.4f over %.0f %% of the texels, %.4f over all\n", name, error, 100 * share, relativeError(drawn, traced.irradiance_rgb));
    EXPECT_LT(error, 0.02) << name;
    EXPECT_GT(share, 0.8) << name;
    EXPECT_LT(relativeError(drawn, traced.irradiance_rgb), 0.03) << name;
    EXPECT_NEAR(meanOf(drawn) / meanOf(traced.irradiance_rgb), 1, 0.02) << name;
  }
}

TEST_P(GlVplRooms, WithoutShadowsAgreeWithTheIrradianceOfTheRuntime) {
  const LitRoom room(twoRooms(), 64, 80);
  lw_gl_vpl_options options = LW_GL_VPL_OPTIONS_INIT;
  options.shadow_map_side = 0;
  EXPECT_LT(relativeError(draw(room, options), room.trace(32, false).irradiance_rgb), 0.01);
}

/// A light that no baking makes, over one texel.
lw_virtual_light polygonAt(const std::vector<float>& corners_m, const float (&normal)[3]) {
  lw_virtual_light light{};
  light.type = LW_VIRTUAL_POLYGON;
  light.vertex_count = uint32_t(corners_m.size() / 3), light.vertices_m = corners_m.data();
  for (size_t k = 0; k < 3; ++k) {
    light.normal[k] = normal[k], light.flux_rgb[k] = 100;
    for (size_t i = k; i < corners_m.size(); i += 3) light.position_m[k] += corners_m[i] / float(light.vertex_count);
  }
  for (uint32_t i = 2; i < light.vertex_count; ++i) {
    const Vec3 o(corners_m[0], corners_m[1], corners_m[2]), a = Vec3(corners_m[3 * i - 3], corners_m[3 * i - 2], corners_m[3 * i - 1]) - o, b = Vec3(corners_m[3 * i], corners_m[3 * i + 1], corners_m[3 * i + 2]) - o;
    light.area_m2 += 0.5f * a.cross(b).length();
  }
  return light;
}

TEST_P(GlVplRooms, OfAnySizeAgreeAndAreNeverNegative) {
  // Irradiance in single points of the GPU against the runtime's own: polygons of all sizes, some through the receiver's horizon, touching it, or grazing.
  scene::Scene box = test::closedBox({1, 1, 1}, test::diffuse(0.5f));
  box.lights.push_back(test::pointLight({0, 0, 0}, 1));
  const LitRoom room(std::move(box), 64, 1);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> both(-1, 1);
  lw_gl_vpl_options options = LW_GL_VPL_OPTIONS_INIT;
  options.shadow_map_side = 0, options.pieces = 1, options.layers = 1;
  for (int n = 0; n < 60; ++n) {
    const float size = std::pow(10.0f, -3 + float(n % 6)), height = n % 4 == 0 ? 1e-4f : std::abs(both(random));
    // On the floor or near it, facing up; or on its edge.
    std::vector<float> corners{-size, -1 + height, -size, -size, -1 + height, size, size, -1 + height, size, size, -1 + height, -size};
    for (size_t i = 0; i < corners.size(); i += 3) corners[i] += both(random), corners[i + 2] += 0.3f;
    for (size_t i = 3; i < corners.size(); i += 3) corners[i] = corners[i] - corners[i + 0] + (i == 3 ? -size : size) + corners[0];
    const lw_virtual_light light = polygonAt(corners, {0, 1, 0});
    if (!(light.area_m2 > 0)) continue;
    const GlVpl vpl = create(room, options);
    ASSERT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 0, &light, 1), LW_OK) << message;
    finish(vpl.get());
    const auto drawn = read(room, vpl.get());  // which checks that no value is negative or NaN
    double largest = 0;
    for (const Vec3d& v : drawn) largest = std::max(largest, v.x);
    for (size_t i = 0; i < drawn.size(); ++i) {
      const atlas::Slot& slot = room.p.atlas.slots[i];
      const Vec3 position_m = slot.position * float(room.p.scene.metres_per_unit);
      const float distance = (position_m - Vec3(light.position_m[0], light.position_m[1], light.position_m[2])).length();
      if (std::max(distance - 1.5f * size, std::abs(position_m.y - light.position_m[1])) < 0.6f) continue;  // there a texel is a mean over four points
      float rgb[3];
      ASSERT_EQ(lw_virtual_light_irradiance(&light, &position_m.x, &slot.normal.x, 0, rgb), LW_OK);
      EXPECT_NEAR(drawn[i].x, rgb[0], 1e-4 * rgb[0] + 1e-5 * largest) << "polygon " << n << ", slot " << i;
    }
  }
}

TEST_P(GlVplRooms, OfAnyScaleHaveTheSameLight) {
  std::vector<Vec3d> one_metre;
  for (const float scale : {1.0f, 1e-3f, 1e4f}) {
    scene::Scene scene = boxesInBox();
    for (Vec3& p : scene.mesh.positions) p *= scale;
    for (scene::Light& light : scene.lights) light.position *= scale, light.intensity *= scale * scale;
    scene.bounds = {scene.bounds.min * scale, scene.bounds.max * scale};
    const LitRoom room(std::move(scene), 32, 40);
    const auto drawn = draw(room, LW_GL_VPL_OPTIONS_INIT);
    if (scale == 1.0f) one_metre = drawn;
    // Clusters of a scaled scene need not be the same; its light is.
    EXPECT_NEAR(meanOf(drawn) / meanOf(one_metre), 1, 0.08) << scale;
    EXPECT_LT(relativeError(drawn, room.trace(24).irradiance_rgb), 0.1) << scale;
  }
}

TEST_P(GlVplRooms, ALightCloseToAWallDoesNotShineThroughIt) {
  // 0.1 mm in front of the partition, facing it: all of its light stays between them.
  const LitRoom room(twoRooms(), 32, 1);
  const std::vector<float> corners{-0.1001f, 1, -1.2f, -0.1001f, 1.4f, -1.2f, -0.1001f, 1.4f, -0.8f, -0.1001f, 1, -0.8f};
  lw_virtual_light light = polygonAt(corners, {1, 0, 0});
  const GlVpl vpl = create(room, LW_GL_VPL_OPTIONS_INIT);
  ASSERT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 0, &light, 1), LW_OK) << message;
  finish(vpl.get());
  const auto drawn = read(room, vpl.get());
  for (size_t i = 0; i < drawn.size(); ++i) {
    const Vec3 position_m = room.p.atlas.slots[i].position * float(room.p.scene.metres_per_unit);
    if (position_m.x > 0) {
      EXPECT_LT(drawn[i].x, 1e-3) << position_m.x << " " << position_m.y << " " << position_m.z;
    }
  }
}

TEST_P(GlVplRooms, SurfacesWithAlphaHideAsMuchAsTheyAreThere) {
  const auto lightBelow = [&](scene::AlphaMode mode, float alpha) {
    test::SceneBuilder builder;
    builder.room({-1, -1, -1}, {1, 1, 1}, builder.material(test::diffuse(0.5f)));
    scene::Material sheet = test::diffuse(0.5f);
    sheet.alpha_mode = mode, sheet.alpha = alpha, sheet.alpha_cutoff = 0.6f;
    builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, builder.material(sheet));
    scene::Scene scene = builder.take();
    scene.lights.push_back(test::pointLight({0, 0.5f, 0}, 1));
    const LitRoom room(std::move(scene), 32, 1);
    const std::vector<float> corners{-0.1f, 0.99f, -0.1f, 0.1f, 0.99f, -0.1f, 0.1f, 0.99f, 0.1f, -0.1f, 0.99f, 0.1f};
    const lw_virtual_light light = polygonAt(corners, {0, -1, 0});
    const GlVpl vpl = create(room, LW_GL_VPL_OPTIONS_INIT);
    EXPECT_EQ(lw_gl_vpl_set_source_lights(vpl.get(), 0, &light, 1), LW_OK) << message;
    finish(vpl.get());
    const auto drawn = read(room, vpl.get());
    double sum = 0;
    for (size_t i = 0; i < drawn.size(); ++i)
      if (room.p.atlas.slots[i].position.y * float(room.p.scene.metres_per_unit) < -0.5f) sum += drawn[i].x;
    return sum;
  };
  const double open = lightBelow(scene::AlphaMode::mask, 0.5f);
  EXPECT_GT(open, 1);
  EXPECT_LT(lightBelow(scene::AlphaMode::mask, 0.7f), 1e-3 * open);
  EXPECT_NEAR(lightBelow(scene::AlphaMode::blend, 0.3f) / open, 0.7, 0.02);
}

TEST_P(GlVplRooms, ShowGuttersAndBuriedTexelsWhatTheirSourceHas) {
  const LitRoom room(boxesInBox(), 32, 20);
  lw_gl_vpl_options options = LW_GL_VPL_OPTIONS_INIT;
  options.atlas_format = LW_GL_ATLAS_RGBA32F;
  lw_gl_vpl* raw = nullptr;
  ASSERT_EQ(lw_gl_vpl_create(gl, room.container, room.virtual_lights, &options, &raw), LW_OK) << message;
  const GlVpl vpl(raw, lw_gl_vpl_destroy);
  finish(vpl.get());
  const auto& source = room.p.atlas.source;
  std::vector<float> rgba(source.size() * 4);
  ASSERT_EQ(lw_gl_vpl_read(vpl.get(), rgba.data()), LW_OK);
  for (size_t texel = 0; texel < source.size(); ++texel) {
    EXPECT_EQ(rgba[texel * 4 + 3], source[texel] == kNone ? 0 : 1);
    if (source[texel] != kNone) {
      EXPECT_EQ(rgba[texel * 4], rgba[size_t(source[texel]) * 4]) << texel;
    }
  }
}

}  // namespace
}  // namespace lightwell::bake
