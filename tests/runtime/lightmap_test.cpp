// Light maps at run time: what texels show, and damage.
#include <gtest/gtest.h>

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

TEST(Lightmap, SaysWhatIsWrong) {
  for (const char* broken : {"order", "range", "short", "missing"}) {
    auto content = format::lightmapContent();
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
