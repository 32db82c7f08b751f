// The runtime's view of the header messages is that of the protobuf library, and the enums have the same numbers.
#include <gtest/gtest.h>

#include "format/decode/headers.h"
#include "format/decode/layout.h"
#include "tests/format/content.h"

namespace lightwell::format {
namespace {

const uint8_t* data(const std::string& s) { return reinterpret_cast<const uint8_t*>(s.data()); }

TEST(Headers, EnumsHaveTheNumbersOfTheSchema) {
  EXPECT_EQ(int(ElementType::bytes), v1::ELEMENT_TYPE_BYTES);
  EXPECT_EQ(int(ElementType::u8), v1::ELEMENT_TYPE_U8);
  EXPECT_EQ(int(ElementType::i8), v1::ELEMENT_TYPE_I8);
  EXPECT_EQ(int(ElementType::u16), v1::ELEMENT_TYPE_U16);
  EXPECT_EQ(int(ElementType::i16), v1::ELEMENT_TYPE_I16);
  EXPECT_EQ(int(ElementType::u32), v1::ELEMENT_TYPE_U32);
  EXPECT_EQ(int(ElementType::f16), v1::ELEMENT_TYPE_F16);
  EXPECT_EQ(int(ElementType::f32), v1::ELEMENT_TYPE_F32);
  EXPECT_EQ(int(ElementType::rgb9e5), v1::ELEMENT_TYPE_RGB9E5);
  EXPECT_EQ(v1::ElementType_MAX, v1::ELEMENT_TYPE_RGB9E5);
  EXPECT_EQ(int(Codec::raw), v1::CODEC_RAW);
  EXPECT_EQ(int(Codec::zstd), v1::CODEC_ZSTD);
  EXPECT_EQ(int(Codec::zstd_planes), v1::CODEC_ZSTD_PLANES);
  EXPECT_EQ(int(Codec::zstd_delta_planes), v1::CODEC_ZSTD_DELTA_PLANES);
  EXPECT_EQ(int(Codec::rans), v1::CODEC_RANS);
  EXPECT_EQ(v1::Codec_MAX, v1::CODEC_RANS);
  EXPECT_EQ(int(PrmLayout::panes), v1::PRM_LAYOUT_PANES);
  EXPECT_EQ(int(PrmLayout::local_bases), v1::PRM_LAYOUT_LOCAL_BASES);
  EXPECT_EQ(int(LightType::point), v1::LIGHT_TYPE_POINT);
  EXPECT_EQ(int(LightType::spot), v1::LIGHT_TYPE_SPOT);
  EXPECT_EQ(int(LightType::directional), v1::LIGHT_TYPE_DIRECTIONAL);
}

TEST(Headers, AtlasAndPrm) {
  Content content = localBasesContent();
  content.atlas.set_unwrapped(true);
  const std::string atlas_bytes = content.atlas.SerializeAsString(), prm_bytes = content.prm.SerializeAsString();
  AtlasHeader atlas;
  ASSERT_TRUE(parseAtlasHeader(data(atlas_bytes), atlas_bytes.size(), atlas));
  EXPECT_EQ(atlas.width, 4u);
  EXPECT_EQ(atlas.height, 4u);
  EXPECT_EQ(atlas.covered_texels, 4u);
  EXPECT_EQ(atlas.charts, 1u);
  EXPECT_TRUE(atlas.unwrapped);
  PrmHeader prm;
  ASSERT_TRUE(parsePrmHeader(data(prm_bytes), prm_bytes.size(), prm));
  EXPECT_EQ(prm.layout, PrmLayout::local_bases);
  EXPECT_EQ(prm.entries, 4u);
  EXPECT_EQ(prm.clusters, 3u);
  EXPECT_EQ(prm.texels, 3u);
  EXPECT_EQ(prm.blocks, 2u);
  EXPECT_EQ(prm.max_rank, 2u);
  EXPECT_EQ(prm.brightest, 0u);
  EXPECT_TRUE(prm.has_emitter);
  for (const int reserved : {2, 4, 77}) {
    content.prm.set_layout(v1::PrmLayout(reserved));
    const std::string bytes = content.prm.SerializeAsString();
    ASSERT_TRUE(parsePrmHeader(data(bytes), bytes.size(), prm));
    EXPECT_EQ(prm.layout, PrmLayout::unknown) << reserved;
  }
}

TEST(Headers, Scene) {
  const v1::SceneHeader wanted = panesContent().scene;
  const std::string bytes = wanted.SerializeAsString();
  SceneHeader scene;
  Light light;
  ASSERT_TRUE(parseSceneHeader(data(bytes), bytes.size(), scene, &light, 1));
  EXPECT_EQ(scene.light_count, 1u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(scene.origin_m[i], wanted.origin(i));
    EXPECT_EQ(scene.bounds_min_m[i], wanted.bounds_min(i));
    EXPECT_EQ(scene.bounds_max_m[i], wanted.bounds_max(i));
    EXPECT_EQ(light.position_m[i], wanted.lights(0).position(i));
    EXPECT_EQ(light.direction[i], wanted.lights(0).direction(i));
    EXPECT_EQ(light.intensity_rgb[i], wanted.lights(0).intensity(i));
  }
  EXPECT_EQ(light.type, LightType::spot);
  EXPECT_EQ(light.name, "lamp");
  EXPECT_EQ(light.inner_cone_angle, 0.25f);
  EXPECT_EQ(light.outer_cone_angle, 0.5f);
  EXPECT_EQ(light.range_m, 0.0f);
  EXPECT_TRUE(parseSceneHeader(data(bytes), bytes.size(), scene, nullptr, 0));
  EXPECT_EQ(scene.light_count, 1u);

  v1::SceneHeader flat = wanted;
  flat.mutable_origin()->RemoveLast();
  const std::string flat_bytes = flat.SerializeAsString();
  EXPECT_FALSE(parseSceneHeader(data(flat_bytes), flat_bytes.size(), scene, nullptr, 0));
  v1::SceneHeader four = wanted;
  four.add_bounds_min(1);
  const std::string four_bytes = four.SerializeAsString();
  EXPECT_FALSE(parseSceneHeader(data(four_bytes), four_bytes.size(), scene, nullptr, 0));
}

}  // namespace
}  // namespace lightwell::format
