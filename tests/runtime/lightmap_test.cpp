// Light maps at run time: what texels show, and damage.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/format/lightmap_content.h"
#include "tests/runtime/support.h"

namespace lightwell::test {
namespace {

using Map = std::unique_ptr<lw_lightmap, decltype(&lw_lightmap_release)>;

Map load(const lw_container* container) {
  lw_lightmap* map = nullptr;
  EXPECT_EQ(lw_lightmap_load(container, &map), LW_OK);
  return {map, lw_lightmap_release};
}

TEST(Lightmap, ShowsItsLightAndFillsFromSources) {
  const auto content = format::lightmapContent();
  const Container container = openMemory(format::toWriter(content).bytes());
  const Map map = load(container.get());
  lw_lightmap_info info;
  ASSERT_EQ(lw_lightmap_get_info(map.get(), &info), LW_OK);
  EXPECT_EQ(info.texels, 3u);
  EXPECT_EQ(info.width, 4u);
  std::vector<float> atlas(size_t(info.width) * info.height * 4);
  lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
  shading.fill = 0;
  ASSERT_EQ(lw_lightmap_shade(map.get(), &shading, atlas.data()), LW_OK);
  EXPECT_EQ(atlas[0], 5.0f);
  EXPECT_EQ(atlas[4], 2.0f);
  EXPECT_EQ(atlas[12], 0.5f);
  EXPECT_EQ(atlas[3], 1.0f);
  EXPECT_EQ(atlas[11], 0.0f) << "texel 2 has no value";
  shading.light = LW_LIGHTMAP_DIRECT;
  ASSERT_EQ(lw_lightmap_shade(map.get(), &shading, atlas.data()), LW_OK);
  EXPECT_EQ(atlas[0], 4.0f);
  EXPECT_EQ(atlas[4], 0.0f);
  // For display every texel shows its source.
  ASSERT_EQ(lw_lightmap_shade(map.get(), nullptr, atlas.data()), LW_OK);
  for (size_t i = 0; i < content.base.source.size(); ++i) {
    const uint32_t source = content.base.source[i];
    const float expected = source == 0 ? 5.0f : source == 1 ? 2.0f : source == 3 ? 0.5f : 0.0f;
    EXPECT_EQ(atlas[i * 4], expected) << i;
  }
  shading.light = 4;
  EXPECT_EQ(lw_lightmap_shade(map.get(), &shading, atlas.data()), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_lightmap_shade(nullptr, nullptr, atlas.data()), LW_INVALID_ARGUMENT);
}

TEST(Lightmap, AUnitTakesValuesBeyondThoseOfTheirEncoding) {
  auto content = format::lightmapContent();
  std::vector<float> atlas(16 * 4);
  for (const float unit : {0x1p-100f, 0x1p-20f, 0x1p20f, 0x1p120f}) {
    content.header.set_unit(unit);
    const Container container = openMemory(format::toWriter(content).bytes());
    const Map map = load(container.get());
    ASSERT_EQ(lw_lightmap_shade(map.get(), nullptr, atlas.data()), LW_OK);
    EXPECT_EQ(atlas[0], 5.0f * unit);
    const float up[3] = {0, 1, 0};
    float rgb[3];
    ASSERT_EQ(lw_lightmap_irradiance(map.get(), nullptr, 0, 0, up, up, rgb), LW_OK);
    EXPECT_EQ(rgb[1], 2.5f * unit);
  }
  content.direct[0] = content.indirect[0] = 0xffffffffu;  // the largest there is
  content.header.set_unit(0x1p126f);
  const Container container = openMemory(format::toWriter(content).bytes());
  const Map map = load(container.get());
  ASSERT_EQ(lw_lightmap_shade(map.get(), nullptr, atlas.data()), LW_OK);
  EXPECT_TRUE(std::isfinite(atlas[0]));
  for (const float unit : {-1.0f, 0x1p-130f, HUGE_VALF, NAN}) {
    content.header.set_unit(unit);
    const Container damaged = openMemory(format::toWriter(content).bytes());
    lw_lightmap* none = nullptr;
    EXPECT_EQ(lw_lightmap_load(damaged.get(), &none), LW_BAD_SECTION) << unit;
  }
}

TEST(Lightmap, GradientsTiltTheNormalAndAreNeverNegative) {
  const Container container = openMemory(format::toWriter(format::directionalContent()).bytes());
  const Map map = load(container.get());
  lw_lightmap_info info;
  ASSERT_EQ(lw_lightmap_get_info(map.get(), &info), LW_OK);
  EXPECT_EQ(info.has_gradients, 1u);
  const float up[3] = {0, 1, 0}, along_x[3] = {1, 0, 0}, against_x[3] = {-1, 0, 0};
  float rgb[3];
  const auto at = [&](uint32_t x, const float* normal, uint32_t light) {
    lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
    shading.light = light, shading.fill = 0;
    EXPECT_EQ(lw_lightmap_irradiance(map.get(), &shading, x, 0, up, normal, rgb), LW_OK);
    return rgb[0];
  };
  // Texel 0: direct 4 with gradient (4, 0, 0), indirect 1 with gradient (0, -4, 0).
  EXPECT_FLOAT_EQ(at(0, up, 3), 5.0f) << "the surface's own normal: the map itself";
  EXPECT_FLOAT_EQ(at(0, along_x, LW_LIGHTMAP_DIRECT), 4 * (1 + 4));
  EXPECT_FLOAT_EQ(at(0, against_x, LW_LIGHTMAP_DIRECT), 0.0f) << "never negative";
  EXPECT_FLOAT_EQ(at(0, along_x, LW_LIGHTMAP_INDIRECT), 1 * (1 + 4));
  EXPECT_FLOAT_EQ(at(1, along_x, 3), 2 * (1 - 16 * 4 / 127.0f));
  EXPECT_FLOAT_EQ(at(2, along_x, 3), 0.0f) << "no value";
  EXPECT_EQ(lw_lightmap_irradiance(map.get(), nullptr, 4, 0, up, up, rgb), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_lightmap_irradiance(map.get(), nullptr, 0, 0, up, nullptr, rgb), LW_INVALID_ARGUMENT);

  // Both lights together: weighted by luminance.
  std::vector<float> gradients(size_t(info.width) * info.height * 3);
  lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
  shading.light = LW_LIGHTMAP_DIRECT, shading.fill = 0;
  ASSERT_EQ(lw_lightmap_shade_gradients(map.get(), &shading, gradients.data()), LW_OK);
  EXPECT_FLOAT_EQ(gradients[0], 4.0f);
  EXPECT_FLOAT_EQ(gradients[1], 0.0f);
  const auto luminance = [](float r, float g, float b) { return 0.2126f * r + 0.7152f * g + 0.0722f * b; };
  const float direct = luminance(4, 2, 1), indirect = luminance(1, 0.5f, 0.25f);
  ASSERT_EQ(lw_lightmap_shade_gradients(map.get(), nullptr, gradients.data()), LW_OK);
  EXPECT_FLOAT_EQ(gradients[0], 4 * direct / (direct + indirect));
  EXPECT_FLOAT_EQ(gradients[1], -4 * indirect / (direct + indirect));
  const auto source = format::directionalContent().base.source;
  for (size_t i = 0; i < source.size(); ++i)
    if (source[i] == 0) {
      EXPECT_FLOAT_EQ(gradients[3 * i], gradients[0]) << "texels show their source";
    }
}

TEST(Lightmap, WithoutGradientsTheNormalDoesNotMatter) {
  const Container container = openMemory(format::toWriter(format::lightmapContent()).bytes());
  const Map map = load(container.get());
  lw_lightmap_info info;
  ASSERT_EQ(lw_lightmap_get_info(map.get(), &info), LW_OK);
  EXPECT_EQ(info.has_gradients, 0u);
  const float up[3] = {0, 1, 0}, along_x[3] = {1, 0, 0};
  float rgb[3];
  ASSERT_EQ(lw_lightmap_irradiance(map.get(), nullptr, 0, 0, up, along_x, rgb), LW_OK);
  EXPECT_EQ(rgb[0], 5.0f);
  std::vector<float> gradients(size_t(info.width) * info.height * 3, 1.0f);
  ASSERT_EQ(lw_lightmap_shade_gradients(map.get(), nullptr, gradients.data()), LW_OK);
  for (const float value : gradients) EXPECT_EQ(value, 0.0f);
}

TEST(Lightmap, SaysWhatIsWrong) {
  for (const char* broken : {"order", "range", "short", "missing", "gradient", "Gradient"}) {
    auto content = format::directionalContent();
    if (broken[0] == 'g') content.direct_gradient.clear();
    if (broken[0] == 'G') content.indirect_gradient.resize(6);
    if (broken[0] == 'o') content.texel[1] = 0;
    if (broken[0] == 'r') content.texel[2] = 16;
    if (broken[0] == 's') content.indirect.pop_back();
    if (broken[0] == 'm') content.direct.clear();
    Host host;
    const lw_config config = host.config();
    {
      const Container container = openMemory(format::toWriter(content).bytes(), &config);
      lw_lightmap* map = nullptr;
      EXPECT_NE(lw_lightmap_load(container.get(), &map), LW_OK) << broken;
      EXPECT_EQ(map, nullptr);
      EXPECT_NE(host.message.find("lightmap"), std::string::npos) << host.message;
    }
    EXPECT_EQ(host.live, 0u);
  }
}

}  // namespace
}  // namespace lightwell::test
