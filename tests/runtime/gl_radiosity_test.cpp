// Radiosity on OpenGL against the CPU.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/runtime/gl_test.h"
#include "tests/runtime/radiosity_fixture.h"

namespace lightwell::test {
namespace {

RoomOptions colouredRoom(double albedo) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {3, 2, 4}, 6, albedo, 0);
  options.walls[0].albedo *= 0.7;
  options.walls[1].albedo *= 0.3;
  options.walls[3].emission = 2;
  options.merge = true;
  return options;
}

class GlRadiosity : public GlTest {
 protected:
  void TearDown() override {
    lw_gl_radiosity_destroy(gpu);
    GlTest::TearDown();
  }
  void upload(const LoadedRoom& room) {
    lw_gl_radiosity_options options = LW_GL_RADIOSITY_OPTIONS_INIT;
    options.atlas_format = LW_GL_ATLAS_RGBA32F;
    ASSERT_EQ(lw_gl_radiosity_create(gl, room.radiosity, &options, &gpu), LW_OK) << message;
  }
  std::vector<float> irradiance(const LoadedRoom& room) {
    std::vector<float> rgb(size_t(room.info.patches) * 3);
    EXPECT_EQ(lw_gl_radiosity_read_irradiance(gpu, rgb.data()), LW_OK) << message;
    return rgb;
  }

  lw_gl_radiosity* gpu = nullptr;
};

TEST_P(GlRadiosity, StepsAsTheCpuDoes) {
  LoadedRoom room(colouredRoom(0.8));
  upload(room);
  const uint32_t all = LW_GL_RADIOSITY_MATERIALS | LW_GL_RADIOSITY_PORTALS | LW_GL_RADIOSITY_DIRECT;
  std::vector<float> direct(size_t(room.info.patches) * 3);
  for (size_t i = 0; i < direct.size(); i += 5) direct[i] = float(i % 11);
  for (int frame = 0; frame < 4; ++frame) {
    if (frame == 1) {
      ASSERT_EQ(lw_radiosity_set_direct(room.state, direct.data()), LW_OK);
    }
    if (frame == 2) {
      lw_radiosity_material material = LW_RADIOSITY_MATERIAL_INIT;
      material.albedo_factor_rgb[1] = 0.5f, material.emission_rgb[2] = 0.25f;
      ASSERT_EQ(lw_radiosity_set_material(room.state, 0, &material), LW_OK);
    }
    ASSERT_EQ(lw_radiosity_step(room.state, uint32_t(frame) + 1), LW_OK);
    ASSERT_EQ(lw_gl_radiosity_upload(gpu, room.state, all), LW_OK) << message;
    ASSERT_EQ(lw_gl_radiosity_step(gpu, uint32_t(frame) + 1), LW_OK);
    EXPECT_LT(relrmse(irradiance(room), room.irradiance()), 1e-5) << frame;
  }
}

TEST_P(GlRadiosity, SolvesToTheSameLight) {
  for (const double albedo : {0.5, 0.9, 0.99, 0.999}) {
    LoadedRoom room(colouredRoom(albedo));
    upload(room);
    room.solve();
    uint32_t sweeps = 0;
    ASSERT_EQ(lw_gl_radiosity_solve(gpu, 1e-3, 1000, &sweeps), LW_OK);
    EXPECT_LT(relrmse(irradiance(room), room.irradiance()), 2e-3) << albedo;
    EXPECT_LE(sweeps, albedo < 0.6 ? 6u : albedo < 0.95 ? 18u : albedo < 0.995 ? 56u : 175u);
    lw_gl_radiosity_destroy(gpu);
    gpu = nullptr;
  }
}

TEST_P(GlRadiosity, ClosedCubeGivesPiOverOneMinusAlbedo) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 4, 0.99, 1);
  LoadedRoom room(options);
  upload(room);
  ASSERT_EQ(lw_gl_radiosity_solve(gpu, 1e-4, 1000, nullptr), LW_OK);
  for (const float e : irradiance(room)) ASSERT_NEAR(e * 0.01 / std::numbers::pi, 1, 1e-3);
}

TEST_P(GlRadiosity, ShadesAsTheCpuDoes) {
  SyntheticRadiosity made = makeRoom(colouredRoom(0.7));
  format::RadiosityContent& c = made.content;
  for (size_t i = 0; i + 4 < c.texel_patch.size(); i += 4) {
    c.texel_patch[i + 1] = c.texel_patch[i + 4];
    c.texel_weight[i] = uint8_t(i % 200), c.texel_weight[i + 1] = uint8_t(255 - i % 200);
    c.texel_exposed[i / 4] = uint8_t(i);
  }
  c.base.source.back() = c.texel[3];
  LoadedRoom room(std::move(made));
  upload(room);
  room.solve();
  const std::vector<float> direct(size_t(room.info.patches) * 3, 0.5f);
  ASSERT_EQ(lw_radiosity_set_direct(room.state, direct.data()), LW_OK);
  ASSERT_EQ(lw_gl_radiosity_upload(gpu, room.state, LW_GL_RADIOSITY_DIRECT), LW_OK);
  room.solve();
  ASSERT_EQ(lw_gl_radiosity_solve(gpu, 1e-5, 1000, nullptr), LW_OK);
  std::vector<float> atlas(size_t(room.info.width) * room.info.height * 4), expected(atlas.size());
  for (uint32_t light = 1; light < 8; ++light)
    for (const uint32_t fill : {0u, 1u}) {
      lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
      shading.light = light, shading.fill = fill;
      ASSERT_EQ(lw_radiosity_shade(room.state, &shading, expected.data()), LW_OK);
      ASSERT_EQ(lw_gl_radiosity_shade(gpu, &shading), LW_OK) << message;
      ASSERT_EQ(lw_gl_radiosity_read_atlas(gpu, atlas.data()), LW_OK) << message;
      EXPECT_LT(relrmse(atlas, expected), 1e-4) << light << " " << fill;
    }
}

TEST_P(GlRadiosity, ClosedDoorsStayDark) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 4, 0.7, 0);
  options.walls[2].emission = 1;
  options.strips = 1;
  options.gate_sets = {{}, {0}};
  options.gate_set = [](uint32_t, uint32_t from) { return uint16_t(from == 2 ? 1 : 0); };
  LoadedRoom room(options);
  upload(room);
  ASSERT_EQ(lw_radiosity_set_portal(room.state, 0, 0), LW_OK);
  ASSERT_EQ(lw_gl_radiosity_upload(gpu, room.state, LW_GL_RADIOSITY_PORTALS), LW_OK);
  ASSERT_EQ(lw_gl_radiosity_solve(gpu, 1e-4, 1000, nullptr), LW_OK);
  for (const float e : irradiance(room)) ASSERT_EQ(e, 0.0f);
  ASSERT_EQ(lw_radiosity_set_portal(room.state, 0, 0.25f), LW_OK);
  ASSERT_EQ(lw_gl_radiosity_upload(gpu, room.state, LW_GL_RADIOSITY_PORTALS), LW_OK);
  ASSERT_EQ(lw_gl_radiosity_solve(gpu, 1e-5, 1000, nullptr), LW_OK);
  room.solve();
  EXPECT_LT(relrmse(irradiance(room), room.irradiance()), 1e-4);
}

TEST_P(GlRadiosity, RefusesWhatCannotBe) {
  LoadedRoom room(colouredRoom(0.5));
  RoomOptions smaller;
  smaller.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 2, 0.5, 0);
  LoadedRoom other(smaller);
  upload(room);
  EXPECT_EQ(lw_gl_radiosity_upload(gpu, other.state, LW_GL_RADIOSITY_DIRECT), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_radiosity_upload(gpu, room.state, 16), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_radiosity_solve(gpu, 0, 10, nullptr), LW_INVALID_ARGUMENT);
  lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
  shading.light = 8;
  EXPECT_EQ(lw_gl_radiosity_shade(gpu, &shading), LW_INVALID_ARGUMENT);
  EXPECT_GT(lw_gl_radiosity_texture_bytes(gpu), 4u * room.info.links);
  EXPECT_NE(lw_gl_radiosity_atlas_texture(gpu), 0u);
  EXPECT_EQ(lw_gl_radiosity_step(nullptr, 1), LW_INVALID_ARGUMENT);
}

std::string apiName(const testing::TestParamInfo<Api>& info) { return info.param == Api::desktop33 ? "Core33" : "Es30"; }
INSTANTIATE_TEST_SUITE_P(Contexts, GlRadiosity, testing::Values(Api::desktop33, Api::embedded30), apiName);

}  // namespace
}  // namespace lightwell::test
