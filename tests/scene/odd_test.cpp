// Files that are odd rather than wrong: as exporters, converters and other programs' tests leave them. Each is read as it was meant, and what was repaired or left out is told.
#include <gmock/gmock.h>

#include "tests/scene/gltf_builder.h"

namespace lightwell::scene {
namespace {

using testing::HasSubstr;
using testing::StartsWith;
using Odd = SceneTest;

constexpr const char* kWhitePixel = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGP4DwABAQEAsTj2FAAAAABJRU5ErkJggg==";

TEST_F(Odd, OfSeveralScenesOnlyTheDefaultIsBaked) {
  GltfBuilder b;
  const size_t first = b.show(b.triangle());
  const size_t second = b.add("nodes", {{"mesh", 0}, {"translation", {5, 0, 0}}});
  b.json["scenes"] = {{{"nodes", {first}}}, {{"nodes", {second}}}};
  b.json["scene"] = 1;
  EXPECT_NEAR(worldPosition(load(b), 0).x, 5, 1e-5);
  EXPECT_TRUE(warned("scenes", "2 scenes; only scenes[1], its default, is baked"));
  b.json.erase("scene");
  EXPECT_NEAR(worldPosition(load(b), 0).x, 0, 1e-5);
  EXPECT_TRUE(warned("scenes", "only scenes[0], the first, is baked"));
}

TEST_F(Odd, ScenesWithoutNodesAndFilesWithoutAnythingHaveNoSurfaces) {
  GltfBuilder b;
  b.json["scenes"][0].erase("nodes");
  b.json["nodes"] = {{{"name", "alone"}}};
  EXPECT_TRUE(load(b).mesh.triangles.empty());
  EXPECT_TRUE(warned("scenes[0]", "has no nodes"));
  EXPECT_TRUE(warned("scenes", "no surfaces"));
  writeBytes(folder / "bare.gltf", "{\"asset\":{\"version\":\"2.0\"}}");
  EXPECT_TRUE(loadFile(folder / "bare.gltf").mesh.triangles.empty());
}

/// The same six vertices in each mode, with indices and without.
TEST_F(Odd, EveryModeOfPrimitives) {
  const std::vector<float> positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0, 1, 2, 0};
  const size_t triangles[] = {0, 0, 0, 0, 2, 4, 4};
  for (int mode = 0; mode < 8; ++mode)
    for (const bool indexed : {false, true}) {
      GltfBuilder b;
      Json primitive = {{"mode", mode}, {"attributes", {{"POSITION", b.accessor<float>(positions, "VEC3", 3)}}}};
      if (indexed) primitive["indices"] = b.accessor<uint8_t>({0, 1, 2, 3, 4, 5}, "SCALAR", 1);
      b.show(primitive);
      if (mode == 7) {
        EXPECT_THAT(errorOf(b), StartsWith("meshes[0].primitives[0].mode: is 7"));
      } else {
        EXPECT_EQ(load(b).mesh.triangles.size(), triangles[mode]) << mode;
        EXPECT_TRUE(mode > 3 || warned("meshes[0].primitives[0]", "is points or lines, not a surface"));
      }
    }
}

TEST_F(Odd, WhatIsNoWholeTriangleIsLeftOutAndTold) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["indices"] = b.accessor<uint16_t>({0, 1, 2, 2, 1}, "SCALAR", 1);
  b.show(primitive);
  EXPECT_EQ(load(b).mesh.triangles.size(), 1u);
  EXPECT_TRUE(warned("meshes[0].primitives[0]", "5 indices make no whole number of triangles; the last two are left out"));
  GltfBuilder plain;
  plain.show({{"attributes", {{"POSITION", plain.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 1}, "VEC3", 3)}}}});
  EXPECT_EQ(load(plain).mesh.triangles.size(), 1u);
  EXPECT_TRUE(warned("meshes[0].primitives[0]", "4 vertices make no whole number of triangles; the last is left out"));
}

TEST_F(Odd, PrimitivesWithoutPositionsOrTrianglesAreLeftOut) {
  GltfBuilder b;
  b.show({{"attributes", {{"NORMAL", b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3)}}}});
  b.show({{"attributes", {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0}, "VEC3", 3)}}}});
  EXPECT_TRUE(load(b).mesh.triangles.empty());
  EXPECT_TRUE(warned("meshes[0].primitives[0]", "has no POSITION and is left out"));
  EXPECT_TRUE(warned("meshes[1].primitives[0]", "has no triangles"));
}

TEST_F(Odd, TenThousandInstancesOfOneMesh) {
  GltfBuilder b;
  b.show(b.triangle());
  for (int i = 1; i < 10'000; ++i)
    b.json["scenes"][0]["nodes"].push_back(b.add("nodes", {{"mesh", 0}, {"translation", {0.01 * i, 0, 0}}}));
  const Scene scene = load(b);
  EXPECT_EQ(scene.objects.size(), 10'000u);
  EXPECT_EQ(scene.mesh.triangles.size(), 10'000u);
  EXPECT_EQ(scene.objects[9999].gltf_path, "nodes[9999]/meshes[0].primitives[0]");
}

TEST_F(Odd, NamesAndFilesInAnyScript) {
  GltfBuilder b;
  b.json["nodes"][b.show(b.triangle())]["name"] = "стена ❤ 壁";
  const Scene scene = loadFile(b.writeGltf(folder / "пример ♻ 例.gltf", "%E4%BE%8B.bin", "例.bin"));
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].name, "стена ❤ 壁");
  EXPECT_THAT(errorOfFile(b.writeGltf(folder / "fehlt.gltf", "ключ.bin", "")), HasSubstr("buffers[0].uri: \"ключ.bin\" does not exist"));
}

TEST_F(Odd, MissingFilesOfAnyKindAreNamed) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["material"] = b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", b.add("textures", {{"source", 0}})}}}}}});
  primitive["attributes"]["TEXCOORD_0"] = b.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  b.add("images", {{"uri", "logo.png"}});
  b.show(primitive);
  EXPECT_THAT(errorOf(b), HasSubstr("images[0].uri: \"logo.png\" does not exist"));
}

TEST_F(Odd, TexturesWithoutCoordinatesAreLookedUpAtTheirCorner) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["material"] = b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.add("textures", {{"source", 0}});
  b.add("images", {{"uri", kWhitePixel}});
  b.show(primitive);
  EXPECT_EQ(load(b).mesh.triangles.size(), 1u);
  EXPECT_TRUE(warned("meshes[0].primitives[0]", "there is no TEXCOORD_0; the texture is looked up at (0, 0)"));
}

/// glTF that is no valid glTF: the first thing that cannot be read is named; what nothing reads does not matter.
TEST_F(Odd, ValuesOfTheWrongType) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["material"] = b.add("materials", {{"pbrMetallicRoughness", Json::object()}});
  primitive["attributes"]["TEXCOORD_0"] = b.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  b.show(primitive);
  b.add("textures", {{"source", 0}});
  b.add("images", {{"uri", kWhitePixel}});
  const auto errorWith = [&](const char* pointer, const Json& value) {
    GltfBuilder odd = b;
    odd.json[Json::json_pointer(pointer)] = value;
    return errorOf(odd);
  };
  const Json texture = {{"index", 0}, {"extensions", {{"KHR_texture_transform", "none"}}}};
  EXPECT_THAT(errorWith("/scene", "first"), StartsWith("scene: is not a number"));
  EXPECT_THAT(errorWith("/meshes/0/primitives", 1), StartsWith("meshes[0].primitives: is not an array"));
  EXPECT_THAT(errorWith("/materials/0/pbrMetallicRoughness", Json::array()), StartsWith("materials[0].pbrMetallicRoughness: is not an object"));
  EXPECT_THAT(errorWith("/materials/0/pbrMetallicRoughness/baseColorTexture", {{"index", -1}}),
              StartsWith("materials[0].pbrMetallicRoughness.baseColorTexture.index: is not a whole number"));
  EXPECT_THAT(errorWith("/materials/0/pbrMetallicRoughness/baseColorTexture", texture), HasSubstr("baseColorTexture.extensions.KHR_texture_transform: is not an object"));
  EXPECT_THAT(errorWith("/nodes/0/children", {0}), StartsWith("nodes[0].children[0]: nodes[0] is reached twice"));
  b.json["asset"]["generator"] = 42;
  b.json["materials"][0]["normalTexture"] = {{"scale", "much"}};
  EXPECT_EQ(load(b).mesh.triangles.size(), 1u);
}

TEST_F(Odd, WhatIsNotNeededIsNotRead) {
  GltfBuilder b;
  b.show(b.triangle());
  b.add("cameras", {{"type", "none"}});
  b.add("animations", {{"channels", "none"}});
  b.json["scenes"][0]["nodes"].push_back(b.add("nodes", {{"camera", 7}}));
  EXPECT_EQ(load(b).mesh.triangles.size(), 1u);
  EXPECT_TRUE(diagnostics.warnings().size() <= 2);
}

}  // namespace
}  // namespace lightwell::scene
