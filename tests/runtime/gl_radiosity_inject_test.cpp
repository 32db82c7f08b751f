// Injection of lamps' light on OpenGL: power, and the same light as on the CPU.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/runtime/gl_test.h"
#include "tests/runtime/radiosity_fixture.h"

namespace lightwell::test {
namespace {

constexpr double kPi = std::numbers::pi;

lw_light spotLight(float inner, float outer) {
  lw_light spot = pointLight(0.3, 1.1, -0.4, 10);
  spot.type = LW_LIGHT_SPOT;
  spot.direction[0] = 0.3f, spot.direction[2] = 0.2f;
  spot.inner_cone_angle_rad = inner, spot.outer_cone_angle_rad = outer;
  return spot;
}

class GlInjection : public GlTest {
 protected:
  void TearDown() override {
    release();
    GlTest::TearDown();
  }
  void release() {
    lw_gl_radiosity_injector_destroy(injector);
    lw_gl_radiosity_destroy(gpu);
    injector = nullptr, gpu = nullptr;
  }
  void upload(const LoadedRoom& room, uint32_t side) {
    release();
    ASSERT_EQ(lw_gl_radiosity_create(gl, room.radiosity, nullptr, &gpu), LW_OK) << message;
    ASSERT_EQ(lw_gl_radiosity_injector_create(gpu, room.container.get(), room.radiosity, side, &injector), LW_OK) << message;
  }
  /// [patches][3].
  std::vector<float> inject(const LoadedRoom& room, const std::vector<lw_light>& lights) {
    std::vector<float> rgb(size_t(room.info.patches) * 3);
    EXPECT_EQ(lw_gl_radiosity_inject(injector, lights.data(), uint32_t(lights.size())), LW_OK) << message;
    EXPECT_EQ(lw_gl_radiosity_read_direct(gpu, rgb.data()), LW_OK) << message;
    return rgb;
  }
  double power(const LoadedRoom& room, const lw_light& light) {
    const auto rgb = inject(room, {light});
    double sum = 0;
    for (uint32_t i = 0; i < room.info.patches; ++i) sum += double(rgb[i * 3]) * double(room.room.content.patch_area[i]);
    return sum;
  }
  static std::vector<float> onCpu(const LoadedRoom& room, uint32_t side, const std::vector<lw_light>& lights) {
    lw_radiosity_injector* made = nullptr;
    EXPECT_EQ(lw_radiosity_injector_create(room.container.get(), room.radiosity, side, &made), LW_OK);
    EXPECT_EQ(lw_radiosity_injector_set_portals(made, room.state), LW_OK);
    std::vector<float> rgb(size_t(room.info.patches) * 3);
    EXPECT_EQ(lw_radiosity_inject(made, lights.data(), uint32_t(lights.size()), rgb.data()), LW_OK);
    lw_radiosity_injector_destroy(made);
    return rgb;
  }

  lw_gl_radiosity* gpu = nullptr;
  lw_gl_radiosity_injector* injector = nullptr;
};

/// Whatever the number of pixels, patches get the lamp's power.
TEST_P(GlInjection, HandsOutAllOfTheLight) {
  LoadedRoom room(box());
  for (const uint32_t side : {32u, 128u, 512u}) {
    upload(room, side);
    const double point = power(room, pointLight(0.3, 1.1, -0.4, 10)) / (4 * kPi * 10);
    std::printf("%u: point %.1e", side, std::abs(point - 1));
    EXPECT_NEAR(point, 1, 1e-4) << side;
    for (const auto& [inner, outer] : {std::pair{0.3f, 0.31f}, {0.0f, 0.6f}, {0.2f, 0.9f}, {0.5f, 1.5f}}) {
      if (side > 500 && outer > 0.5f) break;  // enough of the large pictures
      const double ci = std::cos(double(inner)), co = std::cos(double(outer));
      const double spot = power(room, spotLight(inner, outer)) / (10 * 2 * kPi * ((1 - ci) + (ci - co) / 3));
      std::printf(", spot %.1e", std::abs(spot - 1));
      EXPECT_NEAR(spot, 1, 2e-4) << side << " " << inner << " " << outer;
    }
    std::printf("\n");
  }
}

TEST_P(GlInjection, GivesTheLightThatTheCpuGives) {
  LoadedRoom room(box(4));
  upload(room, 128);
  lw_light near = pointLight(0.4, 1.3, 0.2, 10);
  near.range_m = 1.5f;
  for (const std::vector<lw_light>& lights : std::vector<std::vector<lw_light>>{
           {pointLight(0.4, 1.3, 0.2, 10)}, {near}, {spotLight(0.1f, 0.7f)}, {spotLight(0.5f, 1.5f)}, {near, spotLight(0.2f, 0.5f)}}) {
    const auto gpu_rgb = inject(room, lights), cpu_rgb = onCpu(room, 128, lights);
    EXPECT_LT(relrmse(gpu_rgb, cpu_rgb), 2e-3) << lights.size();
    ASSERT_EQ(lw_radiosity_set_direct(room.state, cpu_rgb.data()), LW_OK);
    room.solve();
    ASSERT_EQ(lw_gl_radiosity_solve(gpu, 1e-5, 100, nullptr), LW_OK);
    std::vector<float> solved(gpu_rgb.size());
    ASSERT_EQ(lw_gl_radiosity_read_irradiance(gpu, solved.data()), LW_OK);
    const double difference = relrmse(solved, room.irradiance());
    std::printf("%zu lights: direct %.1e, solved %.1e\n", lights.size(), relrmse(gpu_rgb, cpu_rgb), difference);
    EXPECT_LT(difference, 1e-3) << lights.size();
  }
  for (const float e : inject(room, {})) ASSERT_EQ(e, 0.0f);
}

TEST_P(GlInjection, DrawsLeavesAsFarAsTheyAreOpen) {
  LoadedRoom room(boxWithLeaf());
  upload(room, 128);
  const std::vector<lw_light> lamp{pointLight(-0.4, 1.2, 0.1, 10)};
  const auto shut_rgb = onCpu(room, 128, lamp);
  for (const float open : {0.0f, 0.3f, 0.5f, 1.0f}) {
    ASSERT_EQ(lw_radiosity_set_portal(room.state, 0, open), LW_OK);
    ASSERT_EQ(lw_gl_radiosity_upload(gpu, room.state, LW_GL_RADIOSITY_PORTALS), LW_OK);
    const auto cpu_rgb = onCpu(room, 128, lamp);
    EXPECT_LT(relrmse(inject(room, lamp), cpu_rgb), 2e-3) << open;
    if (open > 0) {
      EXPECT_GT(relrmse(cpu_rgb, shut_rgb), 0.01) << open;
    }
  }
}

/// A floor below a smaller roof: shadows of a sun, and nothing from below.
TEST_P(GlInjection, DirectionalLightFallsThroughTheRoof) {
  RoomOptions options;
  options.walls = {{{0, 0, 0}, {0, 0, 4}, {4, 0, 0}, 8, 0.5, 0, 0}, {{1, 1, 1}, {0, 0, 2}, {2, 0, 0}, 8, 0.5, 0, 0}};
  LoadedRoom room(options);
  upload(room, 512);
  lw_light sun = pointLight(0, 0, 0, 7);
  sun.type = LW_LIGHT_DIRECTIONAL;
  EXPECT_NEAR(power(room, sun) / (7.0 * 16), 1, 0.005);
  const auto rgb = inject(room, {sun});
  EXPECT_NEAR(rgb[0], 7, 0.1);                // a corner of the floor
  EXPECT_NEAR(rgb[(3 * 8 + 3) * 3], 0, 0.1);  // below the roof
  EXPECT_LT(relrmse(rgb, onCpu(room, 512, {sun})), 0.01);
}

TEST_P(GlInjection, RangeAndBacksAbsorb) {
  LoadedRoom room(box());
  upload(room, 64);
  lw_light point = pointLight(0.5, 1.2, 0, 10);
  point.range_m = 1;
  EXPECT_LT(power(room, point), 0.1 * 4 * kPi * 10);
  // From outside only backs of single-sided walls are seen.
  EXPECT_EQ(power(room, pointLight(50, 1, 0, 10)), 0.0);
}

/// Light of slivers and texels without a patch goes where the CPU sends it: to neighbours, or, when a wall has none, to the nearest patch.
TEST_P(GlInjection, TexelsWithoutPatchesPassTheirLightOn) {
  for (const bool whole_wall : {false, true}) {
    SyntheticRadiosity made = makeRoom(box());
    format::RadiosityContent& c = made.content;
    for (size_t i = c.texel.size(); i-- > 0;) {
      if (whole_wall ? made.wall_of_patch[c.texel_patch[i * 4]] != 2 || i % 25 < 3 : i % 3 != 1) continue;
      c.texel.erase(c.texel.begin() + std::ptrdiff_t(i));
      c.texel_patch.erase(c.texel_patch.begin() + std::ptrdiff_t(i * 4), c.texel_patch.begin() + std::ptrdiff_t(i * 4 + 4));
      c.texel_weight.resize(c.texel_weight.size() - 4);
      c.texel_exposed.pop_back();
    }
    c.header.set_texels(uint32_t(c.texel.size()));
    LoadedRoom room(std::move(made));
    upload(room, 128);
    const lw_light point = pointLight(0.3, 1.1, -0.4, 10);
    EXPECT_NEAR(power(room, point) / (4 * kPi * 10), 1, 1e-4) << whole_wall;
    EXPECT_LT(relrmse(inject(room, {point}), onCpu(room, 128, {point})), 2e-3) << whole_wall;
  }
}

/// A cut-out wall in front of another: light goes where its texture has holes, whatever the texture's wrap modes.
TEST_P(GlInjection, CutOutsLetLightThrough) {
  RoomOptions options;
  options.walls = {{{0, 0, 0}, {0, 0, 4}, {4, 0, 0}, 4, 0.5, 0, 0}, {{1, 1, 1}, {0, 0, 2}, {2, 0, 0}, 4, 0.5, 0, 0}};
  for (const auto wrap : {v1::WRAP_MODE_CLAMP, v1::WRAP_MODE_REPEAT, v1::WRAP_MODE_MIRROR}) {
    SyntheticRadiosity made = makeRoom(options);
    format::RadiosityContent& c = made.content;
    for (const char* chunk : {"alpha_uv", "triangle_alpha", "alpha_material", "alpha_texture_0"}) c.base.left_out.erase(std::string("geometry/") + chunk);
    const float end = wrap == v1::WRAP_MODE_CLAMP ? 1 : 2.3f;
    c.base.triangle_flags = {0, 0, LW_TRIANGLE_CUT_OUT, LW_TRIANGLE_CUT_OUT};
    c.base.triangle_alpha = {0xffff, 0xffff, 0, 0};
    c.base.alpha_uv = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, end, 0, end, end, 0, end};
    c.base.alpha_texture = {0, 255, 0, 255};  // half of it
    c.base.alpha_material.mutable_materials(0)->set_wrap_u(wrap);
    LoadedRoom room(std::move(made));
    upload(room, 256);
    lw_light sun = pointLight(0, 0, 0, 1);
    sun.type = LW_LIGHT_DIRECTIONAL;
    const auto rgb = inject(room, {sun});
    double sum = 0;
    for (uint32_t i = 0; i < 16; ++i) sum += double(rgb[i * 3]) * double(room.room.content.patch_area[i]);
    if (wrap == v1::WRAP_MODE_CLAMP) {
      EXPECT_NEAR(sum, 14, 0.15);
    }
    EXPECT_GT(sum, 12.5);
    EXPECT_LT(relrmse(rgb, onCpu(room, 256, {sun})), 0.01) << wrap;
  }
}

TEST_P(GlInjection, RefusesWhatCannotBe) {
  LoadedRoom room(box(2)), other(box(3));
  upload(room, 16);
  lw_gl_radiosity_injector* none = nullptr;
  EXPECT_EQ(lw_gl_radiosity_injector_create(gpu, room.container.get(), room.radiosity, 4, &none), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_radiosity_injector_create(gpu, room.container.get(), room.radiosity, 5000, &none), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_gl_radiosity_injector_create(gpu, other.container.get(), other.radiosity, 16, &none), LW_INVALID_ARGUMENT);
  EXPECT_EQ(none, nullptr);
  EXPECT_GT(lw_gl_radiosity_injector_texture_bytes(injector), 12u * 16 * 16);
  lw_light light = pointLight(0, 1, 0, 1);
  light.intensity_rgb[1] = NAN;
  EXPECT_EQ(lw_gl_radiosity_inject(injector, &light, 1), LW_INVALID_ARGUMENT);
  EXPECT_THAT(message, testing::HasSubstr("light 0"));
  // On a wall, in a corner, far away: whatever it is, it is finite.
  for (const double at : {0.0, 2.5, 1e30, -1e30})
    for (const float e : inject(room, {pointLight(-1, at, -2, 1e20)})) ASSERT_TRUE(std::isfinite(e) && e >= 0);
}

std::string apiName(const testing::TestParamInfo<Api>& info) { return info.param == Api::desktop33 ? "Core33" : "Es30"; }
INSTANTIATE_TEST_SUITE_P(Contexts, GlInjection, testing::Values(Api::desktop33, Api::embedded30), apiName);

}  // namespace
}  // namespace lightwell::test
