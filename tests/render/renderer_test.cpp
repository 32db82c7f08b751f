// Pictures against arithmetic: every pixel looked at shows a radiance that is known.
#include "render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "render/container_file.h"
#include "render/egl_context.h"
#include "tests/render/stage.h"

namespace lightwell::render {
namespace {

using test::makeStage;
constexpr float kPi = std::numbers::pi_v<float>;

/// The documented tone curve, in double: Hill's ACES fit of exposed grey, then the sRGB encoding.
int displayed(double exposed) {
  const double v = exposed / 0.6;  // the fit's matrices keep grey within 0.1 %
  const double fit = (v * (v + 0.0245786) - 0.000090537) / (v * (0.983729 * v + 0.4329510) + 0.238081);
  const double c = std::clamp(fit, 0.0, 1.0);
  return int(std::lround(255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055)));
}

lw_light pointLight(float x, float y, float z, float candela) {
  lw_light light{};
  light.type = LW_LIGHT_POINT;
  light.direction[1] = -1;
  light.outer_cone_angle_rad = kPi / 4;
  const float position[3] = {x, y, z};
  for (int i = 0; i < 3; ++i) light.position_m[i] = position[i], light.intensity_rgb[i] = candela;
  return light;
}

/// Looks straight down from `height` on the point (x, z) of the floor; x to the right. Albedo 0.5 everywhere.
View downAt(float x, float z, float height, float ev) {
  View view;
  view.eye_m = {x, height, z};
  view.forward = {0, -1, 0};
  view.up = {0, 0, -1};
  view.vertical_fov_rad = 0.2f;
  view.width = view.height = 33;
  view.exposure_ev = ev;
  view.lighting_only = true;
  return view;
}

std::array<int, 3> middlePixel(const Image8& image) {
  const size_t i = (size_t(image.height / 2) * size_t(image.width) + size_t(image.width / 2)) * 4;
  return {image.rgba[i], image.rgba[i + 1], image.rgba[i + 2]};
}

class Stage : public testing::TestWithParam<GlApi> {
 protected:
  Stage() : context(GetParam()) {}
  void open(bool with_transport, double origin_x_m = 0, const EnvironmentSettings* sky = nullptr) {
    bytes = makeStage(with_transport, origin_x_m, sky);
    lw_container* opened = nullptr;
    ASSERT_EQ(lw_open_memory(bytes.data(), bytes.size(), nullptr, &opened), LW_OK);
    container.reset(opened);
    renderer.emplace(container.get(), EglContext::load, nullptr, RendererOptions{.environment = sky ? *sky : EnvironmentSettings{}, .technique = Technique::automatic, .portals = {}});
  }
  void shine(const lw_light& light) { renderer->setLights({&light, 1}); }
  int greyAt(const View& view) {
    const auto rgb = middlePixel(renderer->render(view));
    EXPECT_NEAR(rgb[0], rgb[1], 2);
    EXPECT_NEAR(rgb[1], rgb[2], 2);
    return rgb[1];
  }
  /// What a floor of albedo 0.5 under this irradiance looks like.
  static int expected(double irradiance, double ev) { return displayed(0.5 / kPi * irradiance / (1.2 * std::exp2(ev))); }

  EglContext context;
  std::vector<uint8_t> bytes;
  ContainerFile container;
  std::optional<Renderer> renderer;
};
INSTANTIATE_TEST_SUITE_P(Api, Stage, testing::Values(GlApi::desktop, GlApi::es),
                         [](const auto& info) { return info.param == GlApi::es ? "es" : "desktop"; });

TEST_P(Stage, PointLightFollowsInverseSquareAndCosine) {
  open(false);
  shine(pointLight(0, 2, 0, 100));
  for (const float x : {1.5f, 3.0f, 4.5f}) {
    const double irradiance = 100 * 2 / std::pow(x * x + 4, 1.5);
    EXPECT_NEAR(greyAt(downAt(x, 0, 3, 1)), expected(irradiance, 1), 2) << x;
  }
}

TEST_P(Stage, ShadowsOfAllLightTypesEndWhereTheyMust) {
  open(false);
  lw_light spot = pointLight(0, 2, 0, 100), sun = spot, wide_spot = spot;
  spot.type = wide_spot.type = LW_LIGHT_SPOT;
  spot.inner_cone_angle_rad = 0.8f;
  spot.outer_cone_angle_rad = 0.9f;
  wide_spot.inner_cone_angle_rad = 1.3f;
  wide_spot.outer_cone_angle_rad = 1.5f;
  sun.type = LW_LIGHT_DIRECTIONAL;
  // The plate's edge at half a metre, one metre above the floor: seen from two metres it doubles.
  for (const auto& [light, edge_m] : {std::pair{pointLight(0, 2, 0, 100), 1.0f}, {spot, 1.0f}, {wide_spot, 1.0f}, {sun, 0.5f}}) {
    shine(light);
    // Below the plate, so that it does not hide the floor.
    EXPECT_EQ(greyAt(downAt(edge_m - 0.05f, 0, 0.9f, 0)), 0) << light.type;
    EXPECT_GT(greyAt(downAt(edge_m + 0.05f, 0, 0.9f, 0)), 100) << light.type;
    EXPECT_EQ(greyAt(downAt(0, edge_m - 0.05f, 0.9f, 0)), 0) << light.type;
    EXPECT_GT(greyAt(downAt(0, edge_m + 0.05f, 0.9f, 0)), 100) << light.type;
  }
}

TEST_P(Stage, NoSurfaceShadowsItself) {
  open(false);
  lw_light low_sun = pointLight(0, 0, 0, 100);
  low_sun.type = LW_LIGHT_DIRECTIONAL;
  low_sun.direction[0] = 1, low_sun.direction[1] = -0.1f, low_sun.direction[2] = 0.3f;
  for (const lw_light& light : {pointLight(4.9f, 0.3f, -4.9f, 100), low_sun}) {
    shine(light);
    View view = downAt(-3, 3, 3, -8);  // so bright that only shadow is dark
    view.vertical_fov_rad = 0.8f;
    view.width = view.height = 200;
    const Image8 image = renderer->render(view);
    for (size_t i = 0; i < image.rgba.size(); i += 4) ASSERT_GT(image.rgba[i + 1], 100) << "pixel " << i / 4;
  }
}

TEST_P(Stage, LightsAdd) {
  open(false);
  const std::vector<lw_light> lights(7, pointLight(0, 2, 0, 10));
  renderer->setLights(lights);
  EXPECT_NEAR(greyAt(downAt(3, 0, 3, 0)), expected(70 * 2 / std::pow(13.0, 1.5), 0), 2);
}

TEST_P(Stage, IndirectLightIsTheTransportOfTheLitEntryPoint) {
  open(true);
  const lw_light lamp = pointLight(3, 2, 0, 100);
  shine(lamp);
  const double at_entry = 100.0 / 4, indirect = test::kTransport * at_entry, direct = 100 * 2 / std::pow(2.0 * 2 + 4, 1.5);
  View view = downAt(1, 0, 0.9f, 1);
  view.part = LightPart::indirect;
  EXPECT_NEAR(greyAt(view), expected(indirect, 1), 2);
  view.part = LightPart::direct;
  EXPECT_NEAR(greyAt(view), expected(direct, 1), 2);
  view.part = LightPart::full;
  EXPECT_NEAR(greyAt(view), expected(direct + indirect, 1), 2);
  // The lamp goes where the plate hides it from the entry point: on the line through both, beyond the plate.
  shine(pointLight(-3, 2, 0, 100));
  view.part = LightPart::indirect;
  EXPECT_EQ(greyAt(view), 0);
}

TEST_P(Stage, WithoutTransportThereIsNoIndirectLight) {
  open(false);
  shine(pointLight(0, 2, 0, 100));
  View view = downAt(3, 0, 3, 0);
  view.part = LightPart::indirect;
  EXPECT_EQ(greyAt(view), 0);
  EXPECT_FALSE(renderer->hasTransport());
}

TEST_P(Stage, MeteringFollowsTheLight) {
  open(false);
  shine(pointLight(0, 3, 0, 1));
  View view = downAt(3, 0, 3, 0);
  view.exposure_ev.reset();
  const float ev = renderer->meterExposure(view);
  const int grey = greyAt(view);
  EXPECT_NEAR(grey, 115, 35);
  for (const float factor : {1e-6f, 16.0f, 1e9f}) {
    shine(pointLight(0, 3, 0, factor));
    EXPECT_NEAR(renderer->meterExposure(view), ev + std::log2(factor), 0.05) << factor;
    EXPECT_NEAR(greyAt(view), grey, 2) << factor;
  }
  renderer->setLights({});
  EXPECT_EQ(renderer->meterExposure(view), 0);
}

TEST_P(Stage, CamerasAreInWorldCoordinates) {
  open(false, 1000);
  shine(pointLight(0, 2, 0, 100));  // lights are relative to the container's origin
  EXPECT_NEAR(greyAt(downAt(1003, 0, 3, 1)), expected(200 / std::pow(13.0, 1.5), 1), 2);
}

TEST_P(Stage, BackgroundShowsBesideTheScene) {
  open(false);
  View view = downAt(0, 0, 3, 0);
  view.forward = {0, 1, 0};
  view.background_radiance_rgb = {0.3f, 0.3f, 0.3f};
  EXPECT_NEAR(greyAt(view), displayed(0.3 / 1.2), 2);
}

/// Under the middle of the plate the sky is hidden by the form factor of a square a metre wide, a metre above.
TEST_P(Stage, TheSkyLightsWhatItSees) {
  const double x = test::kPlateHalf / test::kPlateHeight, root = std::sqrt(1 + x * x);
  const double hidden = 4 / (double(kPi)) * x / root * std::atan(x / root);
  for (const uint32_t technique : {LW_ENVIRONMENT_SHARE, LW_ENVIRONMENT_SUM, LW_ENVIRONMENT_UNSHADOWED}) {
    EnvironmentSettings settings;
    settings.technique = technique;
    open(false, 0, &settings);
    ASSERT_TRUE(renderer->hasEnvironment());
    const double under = technique == LW_ENVIRONMENT_UNSHADOWED ? 1 : 1 - hidden;
    EXPECT_NEAR(greyAt(downAt(0, 0, 0.9f, -1)), expected(kPi * under, -1), 3) << technique;
    EXPECT_NEAR(greyAt(downAt(4, 4, 3, -1)), expected(kPi, -1), 3) << technique;
    View view = downAt(0, 0, 3, -1);
    view.part = LightPart::indirect;
    EXPECT_EQ(greyAt(view), 0);
    view.part = LightPart::full;
    view.forward = {0, 1, 0};
    EXPECT_NEAR(greyAt(view), displayed(1 / (1.2 * std::exp2(-1))), 2);
  }
}

TEST_P(Stage, FewerCellsAndSmallerMapsStandForAll) {
  EnvironmentSettings settings;
  settings.cells = 50;
  settings.map_texels = 64;
  open(false, 0, &settings);
  EXPECT_NEAR(greyAt(downAt(4, 4, 3, -1)), expected(kPi, -1), 4);
  settings.cells = 0;
  settings.map_texels = 2048;
  try {
    open(false, 0, &settings);
    FAIL() << "200 maps of 2048 x 2048 texels";
  } catch (const RenderError& error) {
    EXPECT_EQ(error.result, LW_GL_UNSUPPORTED);
  }
}

}  // namespace
}  // namespace lightwell::render
