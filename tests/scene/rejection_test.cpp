// Files that must be refused, each with the place and the reason.
#include <gmock/gmock.h>

#include <chrono>
#include <fstream>

#include "precompute/core/error.h"
#include "precompute/core/random.h"
#include "tests/scene/gltf_builder.h"

namespace lightwell::scene {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class Rejection : public SceneTest {
 protected:
  /// The error of a triangle whose JSON an edit has spoilt.
  template <typename Edit>
  std::string errorAfter(Edit edit) {
    GltfBuilder b;
    Json primitive = b.triangle();
    primitive["indices"] = b.accessor<uint16_t>({0, 1, 2}, "SCALAR", 1);
    b.show(primitive);
    edit(b.json);
    return errorOf(b);
  }
  std::string errorOfText(const std::string& text) {
    writeBytes(folder / "scene.gltf", text);
    return errorOfFile(folder / "scene.gltf");
  }
};

TEST_F(Rejection, Containers) {
  EXPECT_THAT(errorOfFile(folder / "absent.glb"), HasSubstr("no such file"));
  EXPECT_THAT(errorOfFile(folder), HasSubstr("not a regular file"));
  EXPECT_THAT(errorOfText(""), HasSubstr("not JSON"));
  EXPECT_THAT(errorOfText("{\"asset\":"), HasSubstr("not JSON"));
  EXPECT_THAT(errorOfText("[]"), HasSubstr("is not an object"));
  EXPECT_THAT(errorOfText("{\"asset\":{\"version\":\"1.0\"}}"), StartsWith("asset.version: is 1.0"));
  EXPECT_THAT(errorOfText("{\"asset\":{\"version\":2}}"), StartsWith("asset.version: is not a string"));
  EXPECT_THAT(errorOfText("{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(100000, '[')), HasSubstr("nests more than"));
  EXPECT_THAT(errorOfText("glTF"), HasSubstr("ends inside its header"));
  GltfBuilder b;
  b.show(b.triangle());
  const auto file = b.writeGlb(folder / "scene.glb");
  std::filesystem::resize_file(file, std::filesystem::file_size(file) - 4);
  EXPECT_THAT(errorOfFile(file), HasSubstr("cut short"));
}

TEST_F(Rejection, DepthIsThatOfTheJsonNotOfItsStrings) {
  const auto nested = [&](int levels, const std::string& inside) {
    return "{\"asset\":{\"version\":\"2.0\"},\"extras\":" + std::string(size_t(levels), '[') + inside + std::string(size_t(levels), ']') + "}";
  };
  writeBytes(folder / "scene.gltf", nested(63, "\"[[[[\\\"[[[\""));
  EXPECT_EQ(loadFile(folder / "scene.gltf").mesh.triangles.size(), 0u);
  EXPECT_THAT(errorOfText(nested(64, "")), HasSubstr("nests more than"));
}

/// A chain as deep as it is long, and as many siblings: seconds, where work that grows with the square would take hours.
TEST_F(Rejection, AMillionNodesAreNoTrouble) {
  std::string nodes;
  constexpr int kNodes = 1'000'000;
  for (int i = 0; i + 1 < kNodes; ++i) nodes += "{\"children\":[" + std::to_string(i + 1) + "]},";
  writeBytes(folder / "scene.gltf", "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[" + nodes + "{}]}");
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(loadFile(folder / "scene.gltf").mesh.triangles.size(), 0u);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(60));
}

TEST_F(Rejection, UnknownRequiredExtensionsAreNamed) {
  EXPECT_THAT(errorAfter([](Json& j) { j["extensionsRequired"] = {"KHR_mesh_quantization", "ACME_magic"}; }),
              HasSubstr("extensionsRequired[1]: the scene requires the extension ACME_magic"));
  GltfBuilder b;
  b.show(b.triangle());
  b.useExtension("ACME_magic");
  load(b);
  EXPECT_TRUE(warned("extensionsUsed[0]", "ACME_magic"));
}

TEST_F(Rejection, WrongTypesAndIndices) {
  EXPECT_THAT(errorAfter([](Json& j) { j["meshes"] = "none"; }), HasSubstr("meshes: is not an array"));
  EXPECT_THAT(errorAfter([](Json& j) { j["scene"] = 7; }), HasSubstr("scene: is 7, but there are 1 scenes"));
  EXPECT_THAT(errorAfter([](Json& j) { j["scenes"][0]["nodes"][0] = -1; }), HasSubstr("scenes[0].nodes[0]: is not a whole number"));
  EXPECT_THAT(errorAfter([](Json& j) { j["nodes"][0]["mesh"] = 5; }), HasSubstr("nodes[0].mesh: is 5, but there are 1 meshes"));
  EXPECT_THAT(errorAfter([](Json& j) { j["nodes"][0]["translation"] = {1, 2}; }), HasSubstr("nodes[0].translation: has 2 elements"));
  EXPECT_THAT(errorAfter([](Json& j) { j["nodes"][0]["matrix"] = std::vector<int>(16, 1); }), HasSubstr("nodes[0].matrix: is not an affine"));
  EXPECT_THAT(errorAfter([](Json& j) { j["meshes"][0]["primitives"][0]["mode"] = 7; }), HasSubstr("meshes[0].primitives[0].mode: is 7"));
  EXPECT_THAT(errorAfter([](Json& j) { j["meshes"][0]["primitives"][0]["material"] = 0; }), HasSubstr("primitives[0].material: is 0"));
  EXPECT_THAT(errorAfter([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 1.5; }),
              HasSubstr("meshes[0].primitives[0].attributes.POSITION: is not a whole number"));
}

TEST_F(Rejection, Accessors) {
  const std::string position = "meshes[0].primitives[0].attributes.POSITION: ";
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][0]["count"] = 4; }), HasSubstr(position + "accessors[0] needs 4 elements"));
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][0]["byteOffset"] = 1 << 30; }), HasSubstr(position));
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][0]["count"] = 1ull << 52; }), HasSubstr("accessors[0].count: is larger than"));
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][0].erase("bufferView"); j["accessors"][0]["count"] = 50'000'000; }),
              HasSubstr("accessors[0].count: is absurd"));
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][0]["type"] = "VEC2"; }), HasSubstr(position + "the accessor has 2 components"));
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][0]["componentType"] = 5124; }), HasSubstr("accessors[0].componentType: is 5124"));
  EXPECT_THAT(errorAfter([](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }), HasSubstr("shorter than an element"));
  EXPECT_THAT(errorAfter([](Json& j) { j["bufferViews"][0]["byteLength"] = 1 << 20; }), HasSubstr("bufferViews[0]: bytes 0 to 1048576"));
  EXPECT_THAT(errorAfter([](Json& j) { j["bufferViews"][0]["byteOffset"] = 9007199254740992; }), HasSubstr("reach past the buffer"));
  EXPECT_THAT(errorAfter([](Json& j) { j["bufferViews"][0]["buffer"] = 3; }), HasSubstr("bufferViews[0].buffer: is 3"));
  EXPECT_THAT(errorAfter([](Json& j) { j["buffers"] = {{{"byteLength", 1 << 20}}}; }), HasSubstr("buffers[0].byteLength: is 1048576"));
  EXPECT_THAT(errorAfter([](Json& j) {
                j["accessors"][0]["sparse"] = {{"count", 1},
                                               {"indices", {{"bufferView", 1}, {"byteOffset", 4}, {"componentType", 5121}}},
                                               {"values", {{"bufferView", 1}}}};
              }),
              HasSubstr(position + "accessors[0].sparse.values needs 1 elements"));
}

TEST_F(Rejection, IndicesPastTheVertices) {
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][0]["count"] = 2; }),
              HasSubstr("meshes[0].primitives[0].indices: index 2 is 2, but there are 2 vertices"));
  EXPECT_THAT(errorAfter([](Json& j) { j["accessors"][1]["componentType"] = 5122; }), HasSubstr("primitives[0].indices: indices have to be unsigned"));
}

TEST_F(Rejection, PositionsThatAreNotFiniteOrAbsurd) {
  for (const float bad : {NAN, INFINITY, -INFINITY, 1e30f}) {
    GltfBuilder b;
    b.show({{"attributes", {{"POSITION", b.accessor<float>({0, 0, 0, 1, bad, 0, 0, 1, 0}, "VEC3", 3)}}}});
    EXPECT_THAT(errorOf(b), HasSubstr("meshes[0].primitives[0].attributes.POSITION: "));
  }
  for (const double scale : {1e13, 1e-12, 1e300}) {
    GltfBuilder b;
    b.json["nodes"][b.show(b.triangle())]["scale"] = {scale, scale, scale};
    EXPECT_THAT(errorOf(b), HasSubstr("absurdly"));
  }
}

TEST_F(Rejection, CyclesAndSharedChildren) {
  GltfBuilder b;
  const size_t leaf = b.show(b.triangle());
  const size_t root = b.add("nodes", {{"children", {leaf}}});
  b.json["scenes"][0]["nodes"] = {root};
  b.json["nodes"][leaf]["children"] = {root};
  EXPECT_THAT(errorOf(b), HasSubstr("nodes[0].children[0]: nodes[1] is reached twice"));
  b.json["nodes"][leaf].erase("children");
  b.json["nodes"][root]["children"] = {leaf, leaf};
  EXPECT_THAT(errorOf(b), HasSubstr("nodes[0] is reached twice"));
}

TEST_F(Rejection, InstancesWithoutEnd) {
  GltfBuilder b;
  const size_t node = b.show(b.triangle());
  const size_t huge = b.add("accessors", {{"count", 3'000'000}, {"type", "VEC3"}, {"componentType", 5126}});
  b.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {{"TRANSLATION", huge}};
  EXPECT_THAT(errorOf(b), HasSubstr("EXT_mesh_gpu_instancing.attributes: has more instances than the limit"));
}

/// Limits of SECURITY.md, each passed by little: nothing of that size is allocated, but for JSON in a file of its own.
TEST_F(Rejection, FilesAndScenesBeyondTheLimits) {
  writeBytes(folder / "long.glb", "glTF");
  std::filesystem::resize_file(folder / "long.glb", (4ull << 30) + 1);  // a hole
  EXPECT_THAT(errorOfFile(folder / "long.glb"), HasSubstr("more than the limit of 4294967296"));
  writeBytes(folder / "long.gltf", "{");
  std::filesystem::resize_file(folder / "long.gltf", 256ull << 20);
  std::ofstream(folder / "long.gltf", std::ios::app) << '}';  // zeros at the end of a file are none of its JSON
  EXPECT_THAT(errorOfFile(folder / "long.gltf"), HasSubstr("holds more than 268435456 bytes of JSON"));
  GltfBuilder b;
  const size_t many = b.add("accessors", {{"count", 3'000'000}, {"type", "VEC3"}, {"componentType", 5126}});
  b.show({{"attributes", {{"POSITION", many}}}});
  for (int i = 0; i < 23; ++i) b.json["scenes"][0]["nodes"].push_back(b.add("nodes", {{"mesh", 0}}));
  EXPECT_THAT(errorOf(b), HasSubstr("the scene has more vertices than the limit of 67108864"));
}

TEST_F(Rejection, UrisOutsideTheFolder) {
  GltfBuilder b;
  b.show(b.triangle());
  const auto scene_folder = folder / "inside";
  const std::string bytes(b.binary.begin(), b.binary.end());
  writeBytes(folder / "secret.bin", bytes);
  const auto error = [&](const std::string& uri) { return errorOfFile(b.writeGltf(scene_folder / "scene.gltf", uri, "")); };
  for (const std::string& uri : {std::string("../secret.bin"), std::string("a/../../secret.bin"), std::string("%2e%2e/secret.bin"),
                                 (folder / "secret.bin").string()})
    EXPECT_THAT(error(uri), HasSubstr("buffers[0].uri: \"" + uri + "\" leaves the scene's folder"));
  EXPECT_THAT(error("file:///etc/passwd"), HasSubstr("is not a file of the scene's folder"));
  EXPECT_THAT(error("https://example.com/a.bin"), HasSubstr("is not a file of the scene's folder"));
  EXPECT_THAT(error("absent.bin"), HasSubstr("buffers[0].uri: \"absent.bin\" does not exist"));
  std::filesystem::create_symlink(folder / "secret.bin", scene_folder / "link.bin");
  EXPECT_THAT(error("link.bin"), HasSubstr("through a symbolic link"));
  std::filesystem::create_directories(scene_folder / "folder.bin");
  EXPECT_THAT(error("folder.bin"), HasSubstr("not a regular file"));
  EXPECT_THAT(error("data:application/octet-stream;base64,AA*A"), HasSubstr("is not valid base64"));
}

TEST_F(Rejection, UrisInsideTheFolderAreRead) {
  GltfBuilder b;
  b.show(b.triangle());
  EXPECT_EQ(loadFile(b.writeGltf(folder / "a.gltf", "plain.bin", "plain.bin")).mesh.triangles.size(), 1u);
  EXPECT_EQ(loadFile(b.writeGltf(folder / "b.gltf", "sub%20folder/%E2%9D%A4.bin", "sub folder/❤.bin")).mesh.triangles.size(), 1u);
  EXPECT_EQ(loadFile(b.writeGltf(folder / "c.gltf", "./sub/../100%.bin", "100%.bin")).mesh.triangles.size(), 1u);
  // Three vertices, 36 bytes: 1.0f is 00 00 80 3F.
  const std::string base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  EXPECT_EQ(loadFile(b.writeGltf(folder / "d.gltf", "data:application/octet-stream;base64," + base64, "")).mesh.triangles.size(), 1u);
}

/// A file with some bytes changed is either read or refused; whatever is read is sound.
TEST_F(Rejection, DamagedFilesNeverCrash) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["indices"] = b.accessor<uint16_t>({0, 1, 2}, "SCALAR", 1);
  primitive["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3", 3);
  primitive["attributes"]["TEXCOORD_1"] = b.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  b.show(primitive);
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "spot"}, {"intensity", 5}, {"spot", {{"outerConeAngle", 0.5}}}}};
  b.json["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  std::ifstream stream(b.writeGlb(folder / "whole.glb"), std::ios::binary);
  const std::string whole(std::istreambuf_iterator<char>(stream), {});
  int accepted = 0;
  for (uint32_t round = 0; round < 600; ++round) {
    std::string damaged = whole;
    for (uint32_t i = 0; i <= round % 3; ++i) {
      const uint32_t hash = mixBits(combineKeys(round, i));
      damaged[hash % damaged.size()] = char(round % 2 ? hash >> 24 : '0' + (hash >> 24) % 75);
    }
    writeBytes(folder / "damaged.glb", damaged);
    try {
      const Scene scene = loadFile(folder / "damaged.glb");
      for (const Vec3& p : scene.mesh.positions) ASSERT_TRUE(isFinite(p));
      for (const Vec3& n : scene.mesh.normals) ASSERT_NEAR(n.length(), 1, 1e-4);
      for (const auto& t : scene.mesh.triangles)
        for (const uint32_t v : t) ASSERT_LT(v, scene.mesh.positions.size());
      for (const Light& light : scene.lights) ASSERT_TRUE(isFinite(light.position) && isFinite(light.direction) && isFinite(light.intensity));
      ++accepted;
    } catch (const InputError& e) {
      ASSERT_FALSE(e.reason.empty());
    }
  }
  EXPECT_GT(accepted, 20);
}

}  // namespace
}  // namespace lightwell::scene
