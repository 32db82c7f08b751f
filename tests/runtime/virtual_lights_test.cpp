// Virtual lights at run time: what they hold, what they give to points, and damage.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/format/vpl_content.h"
#include "tests/runtime/support.h"

namespace lightwell::test {
namespace {

using Lights = std::unique_ptr<lw_virtual_lights, decltype(&lw_virtual_lights_release)>;

Lights load(const lw_container* container) {
  lw_virtual_lights* lights = nullptr;
  EXPECT_EQ(lw_virtual_lights_load(container, &lights), LW_OK);
  return {lights, lw_virtual_lights_release};
}

TEST(VirtualLights, HoldWhatTheContainerDoes) {
  const auto content = format::vplContent();
  const Container container = openMemory(format::toWriter(content).bytes());
  const Lights lights = load(container.get());
  lw_virtual_lights_info info;
  ASSERT_EQ(lw_virtual_lights_get_info(lights.get(), &info), LW_OK);
  EXPECT_EQ(info.lights, 4u);
  EXPECT_EQ(info.sources, content.header.sources());
  lw_virtual_light light;
  ASSERT_EQ(lw_virtual_lights_get(lights.get(), 3, &light), LW_OK);
  EXPECT_EQ(light.type, uint32_t(LW_VIRTUAL_POLYGON));
  EXPECT_EQ(light.vertex_count, 4u);
  EXPECT_FLOAT_EQ(light.area_m2, 1);
  EXPECT_EQ(light.bounce, 0u);
  EXPECT_EQ(light.flux_rgb[0], 4);
  EXPECT_EQ(lw_virtual_lights_get(lights.get(), 4, &light), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_virtual_light_irradiance(nullptr, nullptr, nullptr, 0, nullptr), LW_INVALID_ARGUMENT);
}

TEST(VirtualLights, OfEveryTypeAreAlikeFromAfarAndFiniteNear) {
  const Container container = openMemory(format::toWriter(format::vplContent()).bytes());
  const Lights lights = load(container.get());
  std::mt19937 random(3);
  std::uniform_real_distribution<float> both(-1, 1);
  for (uint32_t i = 0; i < 4; ++i) {
    lw_virtual_light light;
    ASSERT_EQ(lw_virtual_lights_get(lights.get(), i, &light), LW_OK);
    // Straight ahead, 100 m away, facing the light.
    float position[3], normal[3], rgb[3];
    for (int k = 0; k < 3; ++k) position[k] = light.position_m[k] + 100 * light.normal[k], normal[k] = -light.normal[k];
    ASSERT_EQ(lw_virtual_light_irradiance(&light, position, normal, 0, rgb), LW_OK);
    EXPECT_NEAR(rgb[0] / (light.flux_rgb[0] / (float(M_PI) * 1e4f)), 1, 1e-3f) << i;
    for (int k = 0; k < 3; ++k) position[k] = light.position_m[k] - 100 * light.normal[k], normal[k] = light.normal[k];
    ASSERT_EQ(lw_virtual_light_irradiance(&light, position, normal, 0, rgb), LW_OK);
    EXPECT_EQ(rgb[0], 0) << "nothing comes from behind";
    for (int n = 0; n < 2000; ++n) {
      const float scale = std::pow(10.0f, -8 + 9 * std::abs(both(random)));
      float length = 0;
      for (int k = 0; k < 3; ++k) {
        position[k] = light.position_m[k] + (n % 10 ? both(random) * scale : 0.0f);
        normal[k] = both(random), length += normal[k] * normal[k];
      }
      for (float& v : normal) v /= std::sqrt(length);
      ASSERT_EQ(lw_virtual_light_irradiance(&light, position, normal, n % 3 ? 0.0f : 0.01f, rgb), LW_OK);
      ASSERT_TRUE(rgb[0] >= 0 && std::isfinite(rgb[0])) << i << " " << n;
      ASSERT_TRUE(light.type != LW_VIRTUAL_POLYGON || rgb[0] <= light.flux_rgb[0] / light.area_m2 * 1.0001f) << "no more than a hemisphere of its radiosity";
    }
  }
}

TEST(VirtualLights, PointsAreEvenOverThePolygon) {
  const Container container = openMemory(format::toWriter(format::vplContent()).bytes());
  const Lights lights = load(container.get());
  for (const uint32_t index : {1u, 3u}) {
    lw_virtual_light light;
    ASSERT_EQ(lw_virtual_lights_get(lights.get(), index, &light), LW_OK);
    double mean[3] = {}, square = 0;
    constexpr int kSteps = 100;
    for (int y = 0; y < kSteps; ++y)
      for (int x = 0; x < kSteps; ++x) {
        const float uv[2] = {(float(x) + 0.5f) / kSteps, (float(y) + 0.5f) / kSteps};
        float at[3];
        ASSERT_EQ(lw_virtual_light_point(&light, uv, at), LW_OK);
        for (int k = 0; k < 3; ++k) {
          mean[k] += double(at[k]) / (kSteps * kSteps);
          square += std::pow(double(at[k] - light.position_m[k]), 2) / (kSteps * kSteps);
        }
      }
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(mean[k], double(light.position_m[k]), 2e-3);
    EXPECT_NEAR(square, index == 1 ? 0.5 * 0.25 : 1.0 / 6, 2e-3);
  }
}

TEST(VirtualLights, EpsilonLightensTheCorner) {
  // A polygon on the floor, a receiver on the wall beside it just below the floor's plane: hidden by it, but for half a texel.
  const float vertices[12] = {0, 0, 0, 0, 0, 1, 1, 0, 1, 1, 0, 0};
  lw_virtual_light light = {};
  light.type = LW_VIRTUAL_POLYGON;
  light.normal[1] = 1, light.position_m[0] = light.position_m[2] = 0.5f;
  light.flux_rgb[0] = light.flux_rgb[1] = light.flux_rgb[2] = 1;
  light.area_m2 = 1, light.vertex_count = 4, light.vertices_m = vertices;
  const float below[3] = {0, -0.001f, 0.5f}, above[3] = {0, 0.01f, 0.5f}, normal[3] = {1, 0, 0};
  float dark[3], moved[3], expected[3];
  ASSERT_EQ(lw_virtual_light_irradiance(&light, below, normal, 0, dark), LW_OK);
  ASSERT_EQ(lw_virtual_light_irradiance(&light, below, normal, 0.01f, moved), LW_OK);
  ASSERT_EQ(lw_virtual_light_irradiance(&light, above, normal, 0, expected), LW_OK);
  EXPECT_EQ(dark[0], 0);
  EXPECT_NEAR(moved[0] / expected[0], 1, 1e-5f);
  EXPECT_GT(moved[0], 0.4f);
}

TEST(VirtualLights, SayWhatIsWrong) {
  for (const char* broken : {"type", "source", "vertices", "radius", "normal", "flux", "nothing", "turned"}) {
    auto content = format::vplContent();
    if (broken[0] == 't' && broken[1] == 'y') content.type[0] = 9;
    if (broken[0] == 's') content.source[3] = content.header.sources();
    if (broken[0] == 'v') content.first_vertex[3] = 2;
    if (broken[0] == 'r') content.radius[1] = 0;
    if (broken[0] == 'n' && broken[2] == 'r') content.normal[1] = 0;
    if (broken[0] == 'f') content.flux[2] = -1;
    if (broken[0] == 'n' && broken[2] == 't') content.header.set_lights(0);
    if (broken[0] == 't' && broken[1] == 'u') content.normal[10] = 1;
    Host host;
    const lw_config config = host.config();
    {
      const Container container = openMemory(format::toWriter(content).bytes(), &config);
      lw_virtual_lights* lights = nullptr;
      EXPECT_NE(lw_virtual_lights_load(container.get(), &lights), LW_OK) << broken;
      EXPECT_EQ(lights, nullptr);
      EXPECT_NE(host.message.find("vpl"), std::string::npos) << host.message;
    }
    EXPECT_EQ(host.live, 0u);
  }
}

}  // namespace
}  // namespace lightwell::test
