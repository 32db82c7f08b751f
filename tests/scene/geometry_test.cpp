// Vertices and triangles: whatever a file encodes them as, the same surface comes out.
#include <gmock/gmock.h>

#include <cmath>

#include "precompute/core/error.h"
#include "tests/scene/gltf_builder.h"

namespace lightwell::scene {
namespace {

using testing::HasSubstr;
using Geometry = SceneTest;

const std::vector<float> kQuad = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};  // as a strip: two triangles facing +z

double area(const Scene& scene) {
  double sum = 0;
  for (const auto& t : scene.mesh.triangles) {
    const Vec3d a(scene.mesh.positions[t[0]]), b(scene.mesh.positions[t[1]]), c(scene.mesh.positions[t[2]]);
    sum += (b - a).cross(c - a).length() / 2;
  }
  return sum * scene.metres_per_unit * scene.metres_per_unit;
}

void expectNear(const Vec3d& value, const Vec3d& expected, double tolerance = 1e-5) {
  EXPECT_LT((value - expected).length(), tolerance) << value << " instead of " << expected;
}

TEST_F(Geometry, TriangleWithoutIndicesNormalsOrMaterialFacesItsWinding) {
  GltfBuilder b;
  b.show(b.triangle());
  const Scene scene = load(b);
  ASSERT_EQ(scene.mesh.triangles.size(), 1u);
  EXPECT_NEAR(area(scene), 0.5, 1e-6);
  for (const Vec3& n : scene.mesh.normals) expectNear(Vec3d(n), {0, 0, 1});
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_EQ(scene.objects[0].gltf_path, "nodes[0]/meshes[0].primitives[0]");
  EXPECT_FALSE(scene.objects[0].has_lightmap_uv);
  EXPECT_TRUE(scene.mesh.lightmap_uv.empty());
}

TEST_F(Geometry, StripsAndFansAreWoundLikeLists) {
  for (const int mode : {4, 5, 6}) {
    GltfBuilder b;
    const std::vector<uint16_t> indices = mode == 4   ? std::vector<uint16_t>{0, 1, 2, 2, 1, 3}
                                          : mode == 5 ? std::vector<uint16_t>{0, 1, 2, 3}
                                                      : std::vector<uint16_t>{0, 1, 3, 2};
    b.show({{"attributes", {{"POSITION", b.accessor(kQuad, "VEC3", 3)}}}, {"indices", b.accessor(indices, "SCALAR", 1)}, {"mode", mode}});
    const Scene scene = load(b);
    ASSERT_EQ(scene.mesh.triangles.size(), 2u) << mode;
    EXPECT_NEAR(area(scene), 1, 1e-6) << mode;
    for (uint32_t t = 0; t < 2; ++t) expectNear(faceNormal(scene, t), {0, 0, 1});
  }
}

TEST_F(Geometry, PointsAndLinesAreLeftOutWithACountedWarning) {
  GltfBuilder b;
  for (const int mode : {0, 1, 2, 3}) {
    Json primitive = b.triangle();
    primitive["mode"] = mode;
    b.show(primitive);
  }
  const Scene scene = load(b);
  EXPECT_TRUE(scene.mesh.triangles.empty());
  EXPECT_TRUE(scene.bounds.isEmpty());
  EXPECT_TRUE(warned("meshes[0].primitives[0]", "4 primitives are points or lines"));
  EXPECT_TRUE(warned("scenes", "no surfaces"));
}

TEST_F(Geometry, QuantizedNormalizedAndInterleavedAttributesGiveTheSameVertices) {
  GltfBuilder b;
  b.useExtension("KHR_mesh_quantization", true);
  // Position (short, not normalised), normal (signed byte, normalised), lightmap coordinates (unsigned short, normalised), one vertex in 16 bytes.
  struct Vertex {
    int16_t position[4];
    int8_t normal[4];
    uint16_t uv[2];
  };
  const Vertex vertices[3] = {{{0, 0, 0, 0}, {0, 0, 127, 0}, {0, 0}},
                              {{1000, 0, 0, 0}, {0, 0, 127, 0}, {65535, 0}},
                              {{0, 1000, 0, 0}, {0, -128, 0, 0}, {0, 65535}}};
  const size_t view = b.view(vertices, sizeof vertices, sizeof(Vertex));
  const size_t position = b.accessorOfView(view, 3, "VEC3", 5122);
  const size_t normal = b.accessorOfView(view, 3, "VEC3", 5120, true);
  const size_t uv = b.accessorOfView(view, 3, "VEC2", 5123, true);
  b.json["accessors"][normal]["byteOffset"] = 8;
  b.json["accessors"][uv]["byteOffset"] = 12;
  const size_t node = b.show({{"attributes", {{"POSITION", position}, {"NORMAL", normal}, {"TEXCOORD_1", uv}}}});
  b.json["nodes"][node]["scale"] = {0.001, 0.001, 0.001};
  const Scene scene = load(b);
  ASSERT_EQ(scene.mesh.positions.size(), 3u);
  EXPECT_NEAR(area(scene), 0.5, 1e-6);
  expectNear(Vec3d(scene.mesh.normals[0]), {0, 0, 1});
  expectNear(Vec3d(scene.mesh.normals[2]), {0, -1, 0});  // −128 is −1 as well
  EXPECT_EQ(scene.mesh.lightmap_uv[1], Vec2(1, 0));
  EXPECT_EQ(scene.mesh.lightmap_uv[2], Vec2(0, 1));
  EXPECT_TRUE(scene.objects[0].has_lightmap_uv);
}

TEST_F(Geometry, TheMostNegativeNormalizedIntegersAreMinusOne) {
  GltfBuilder b;
  b.useExtension("KHR_mesh_quantization", true);
  b.show({{"attributes", {{"POSITION", b.accessor<int8_t>({-128, 0, 0, 127, 0, 0, 0, 127, 0}, "VEC3", 3, true)}}}});
  b.show({{"attributes", {{"POSITION", b.accessor<int16_t>({-32768, 0, 0, 32767, 0, 0, 0, 32767, 0}, "VEC3", 3, true)}}}});
  const Scene scene = load(b);
  EXPECT_EQ(worldPosition(scene, 0), Vec3d(-1, 0, 0));
  EXPECT_EQ(worldPosition(scene, 3), Vec3d(-1, 0, 0));
}

TEST_F(Geometry, SparseAccessorReplacesElementsAndMayHaveNoBase) {
  GltfBuilder b;
  const size_t indices = b.view(std::vector<uint16_t>{1, 2}), values = b.view(std::vector<float>{2, 0, 0, 0, 2, 0});
  const size_t position = b.add("accessors", {{"count", 3}, {"type", "VEC3"}, {"componentType", 5126}});
  b.json["accessors"][position]["sparse"] = {
      {"count", 2}, {"indices", {{"bufferView", indices}, {"componentType", 5123}}}, {"values", {{"bufferView", values}}}};
  b.show({{"attributes", {{"POSITION", position}}}});
  EXPECT_NEAR(area(load(b)), 2, 1e-6);
}

TEST_F(Geometry, MirroringKeepsTheFrontAndNonUniformScaleKeepsNormalsPerpendicular) {
  GltfBuilder b;
  // A slope whose normal is (1, 0, 1) / sqrt 2.
  const float h = std::sqrt(0.5f);
  const Json primitive = {{"attributes",
                           {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, -1, 0, 1, 0}, "VEC3", 3)},
                            {"NORMAL", b.accessor<float>({h, 0, h, h, 0, h, h, 0, h}, "VEC3", 3)}}}};
  const size_t node = b.show(primitive);
  for (const auto& scale : {Json{1, 1, 1}, Json{-1, 1, 1}, Json{3, 1, 1}, Json{-3, -2, -0.5}, Json{1, -1, -4}}) {
    b.json["nodes"][node]["scale"] = scale;
    const Scene scene = load(b);
    const Vec3d expected = Vec3d(1 / scale[0].get<double>(), 0, 1 / scale[2].get<double>()).normalized();
    expectNear(faceNormal(scene, 0), expected);
    for (const Vec3& n : scene.mesh.normals) expectNear(Vec3d(n), expected);
  }
}

TEST_F(Geometry, FlattenedTrianglesAreDroppedWithACountedWarning) {
  GltfBuilder b;
  const size_t node = b.show(b.triangle());
  b.json["nodes"][node]["scale"] = {1, 0, 1};
  b.show(b.triangle());
  const Scene scene = load(b);
  EXPECT_EQ(scene.mesh.triangles.size(), 1u);
  EXPECT_EQ(scene.objects.size(), 1u);
  EXPECT_TRUE(warned("nodes[0]", "1 triangles are degenerate"));
}

TEST_F(Geometry, SliversAreKept) {
  GltfBuilder b;
  b.show({{"attributes", {{"POSITION", b.accessor<float>({0, 0, 0, 1, 0, 0, 0.5f, 1e-5f, 0}, "VEC3", 3)}}}});
  EXPECT_EQ(load(b).mesh.triangles.size(), 1u);
}

TEST_F(Geometry, BrokenNormalsAreRepaired) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["attributes"]["NORMAL"] = b.accessor<float>({0, 0, 3, 0, 0, 0, 0, 0, -1}, "VEC3", 3);
  b.show(primitive);
  const Scene scene = load(b);
  for (const Vec3& n : scene.mesh.normals) expectNear(Vec3d(n), {0, 0, 1});
  EXPECT_TRUE(warned("NORMAL", "2 normals are not of unit length"));
  EXPECT_TRUE(warned("nodes[0]", "1 vertex normals are zero"));
  EXPECT_TRUE(warned("nodes[0]", "1 vertex normals point away from the front"));
}

TEST_F(Geometry, UnusedVerticesDoNotCount) {
  GltfBuilder b;
  std::vector<float> positions = kQuad;
  positions.insert(positions.end(), {1e6f, 1e6f, 1e6f});
  std::vector<float> normals;
  for (int i = 0; i < 5; ++i) normals.insert(normals.end(), {0, 0, 1});
  b.show({{"attributes", {{"POSITION", b.accessor(positions, "VEC3", 3)}, {"NORMAL", b.accessor(normals, "VEC3", 3)}}},
          {"indices", b.accessor<uint8_t>({0, 1, 2, 2, 1, 3}, "SCALAR", 1)}});
  const Scene scene = load(b);
  EXPECT_EQ(scene.mesh.positions.size(), 4u);
  expectNear(scene.origin_m, {0.5, 0.5, 0});
}

TEST_F(Geometry, ScenesOfAnySizeAndPlaceBecomeAlike) {
  for (const double scale : {1e-4, 1.0, 7.0, 1e6})
    for (const double offset : {0.0, 12345.0}) {
      GltfBuilder b;
      const size_t node = b.show(b.triangle());
      b.json["nodes"][node]["scale"] = {scale, scale, scale};
      b.json["nodes"][node]["translation"] = {offset * scale, 0, -offset * scale};
      const Scene scene = load(b);
      const float extent = scene.bounds.size().x;
      EXPECT_GE(extent, 8);
      EXPECT_LT(extent, 16);
      EXPECT_EQ(std::exp2(std::round(std::log2(scene.metres_per_unit))), scene.metres_per_unit);
      expectNear(worldPosition(scene, 1) / scale, {1 + offset, 0, -offset}, 1e-6 * (1 + offset));
    }
}

TEST_F(Geometry, TransformsAreComposedInDoublePrecision) {
  GltfBuilder b;
  const size_t leaf = b.show(b.triangle());
  const double far = 1e8;  // a float would be off by metres here
  b.json["nodes"][leaf]["translation"] = {-far, 0.25, 0};
  const size_t root = b.add("nodes", {{"translation", {far, 0, 0}}, {"children", {leaf}}});
  b.json["scenes"][0]["nodes"] = {root};
  const Scene scene = load(b);
  expectNear(worldPosition(scene, 0), {0, 0.25, 0}, 1e-6);
}

TEST_F(Geometry, MatrixAndTranslationRotationScaleAgree) {
  GltfBuilder b;
  const size_t first = b.show(b.triangle());
  b.json["nodes"][first]["translation"] = {5, 6, 7};
  b.json["nodes"][first]["rotation"] = {0, 0, std::sqrt(0.5), std::sqrt(0.5)};  // +90° about z: x to y
  b.json["nodes"][first]["scale"] = {2, 3, 4};
  const Scene a = load(b);
  expectNear(worldPosition(a, 1), {5, 8, 7});
  expectNear(worldPosition(a, 2), {2, 6, 7});
  b.json["nodes"][first] = {{"mesh", 0}, {"matrix", {0, 2, 0, 0, -3, 0, 0, 0, 0, 0, 4, 0, 5, 6, 7, 1}}};
  const Scene m = load(b);
  for (uint32_t v = 0; v < 3; ++v) expectNear(worldPosition(a, v), worldPosition(m, v));
}

TEST_F(Geometry, ParentTransformsActAfterThoseOfTheirChildren) {
  GltfBuilder b;
  const size_t leaf = b.show(b.triangle());
  b.json["nodes"][leaf]["translation"] = {1, 0, 0};
  const size_t root = b.add("nodes", {{"translation", {0, 5, 0}}, {"scale", {2, 2, 2}}, {"children", {leaf}}});
  b.json["scenes"][0]["nodes"] = {root};
  expectNear(worldPosition(load(b), 1), {4, 5, 0});
}

TEST_F(Geometry, DeepHierarchiesDoNotOverflowTheStack) {
  GltfBuilder b;
  size_t child = b.show(b.triangle());
  for (int i = 0; i < 5000; ++i) child = b.add("nodes", {{"translation", {0.001, 0, 0}}, {"children", {child}}});
  b.json["scenes"][0]["nodes"] = {child};
  expectNear(worldPosition(load(b), 0), {5, 0, 0}, 1e-5);
}

TEST_F(Geometry, SharedMeshesAndGpuInstancesEachBecomeObjects) {
  GltfBuilder b;
  b.useExtension("EXT_mesh_gpu_instancing", true);
  const size_t node = b.show(b.triangle());
  b.json["nodes"][node]["translation"] = {0, 0, 1};
  b.json["nodes"][node]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = {
      {"TRANSLATION", b.accessor<float>({10, 0, 0, 20, 0, 0}, "VEC3", 3)},
      {"ROTATION", b.accessor<int8_t>({0, 0, 0, 127, 0, 0, 127, 0}, "VEC4", 4, true)},  // identity, 180° about z
      {"SCALE", b.accessor<float>({1, 1, 1, 2, 2, 2}, "VEC3", 3)}};
  const size_t twin = b.add("nodes", {{"mesh", 0}, {"name", "twin"}});
  b.json["scenes"][0]["nodes"].push_back(twin);
  const Scene scene = load(b);
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[1].gltf_path, "nodes[0]/meshes[0].primitives[0]#1");
  EXPECT_EQ(scene.objects[2].name, "twin");
  EXPECT_EQ(scene.objects[2].first_triangle, 2u);
  EXPECT_EQ(scene.mesh.triangle_object[2], 2u);
  expectNear(worldPosition(scene, scene.objects[0].first_vertex), {10, 0, 1}, 1e-4);
  expectNear(worldPosition(scene, scene.objects[1].first_vertex + 1), {18, 0, 1}, 1e-4);
}

TEST_F(Geometry, MorphTargetsAreBakedInTheRestPose) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["targets"] = {{{"POSITION", b.accessor<float>({0, 0, 0, 2, 0, 0, 0, 0, 0}, "VEC3", 3)}}};
  const size_t node = b.show(primitive);
  b.json["meshes"][0]["weights"] = {0.5};
  expectNear(worldPosition(load(b), 1), {2, 0, 0});
  EXPECT_TRUE(warned("meshes[0].primitives[0]", "morph"));
  b.json["nodes"][node]["weights"] = {1.0};  // the node's own weights win
  expectNear(worldPosition(load(b), 1), {3, 0, 0});
}

TEST_F(Geometry, SkinsAreBakedInTheRestPoseAndIgnoreTheirNode) {
  GltfBuilder b;
  Json primitive = b.triangle();
  primitive["attributes"]["JOINTS_0"] = b.accessor<uint8_t>({0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  primitive["attributes"]["WEIGHTS_0"] = b.accessor<float>({1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  const size_t node = b.show(primitive);
  const size_t fixed = b.add("nodes", Json::object()), raised = b.add("nodes", {{"translation", {0, 0, 4}}});
  b.json["scenes"][0]["nodes"] = {node, fixed, raised};
  // The second joint was bound one metre up: moving from 1 to 4 lifts by 3.
  const std::vector<float> inverse_bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, -1, 1};
  b.add("skins", {{"joints", {fixed, raised}}, {"inverseBindMatrices", b.accessor(inverse_bind, "MAT4", 16)}});
  b.json["nodes"][node]["skin"] = 0;
  b.json["nodes"][node]["translation"] = {100, 100, 100};
  const Scene scene = load(b);
  expectNear(worldPosition(scene, 0), {0, 0, 0});
  expectNear(worldPosition(scene, 1), {1, 0, 1.5});
  expectNear(worldPosition(scene, 2), {0, 1, 3});
  EXPECT_TRUE(warned("meshes[0].primitives[0]", "skin"));
}

TEST_F(Geometry, JointsAreThoseOfTheSkin) {
  for (const float joint : {-1.0f, 1.0f, 1e20f}) {
    GltfBuilder b;
    Json primitive = b.triangle();
    primitive["attributes"]["JOINTS_0"] = b.accessor<float>({0, 0, 0, 0, joint, 0, 0, 0, 0, 0, 0, 0}, "VEC4", 4);
    primitive["attributes"]["WEIGHTS_0"] = b.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
    const size_t node = b.show(primitive);
    b.add("skins", {{"joints", {node}}});
    b.json["nodes"][node]["skin"] = 0;
    EXPECT_THAT(errorOf(b), testing::HasSubstr("element 1 names a joint that the skin does not have"));
  }
}

TEST_F(Geometry, MissingLightmapCoordinatesAreMarkedPerObject) {
  GltfBuilder b;
  b.show(b.triangle());
  Json with = b.triangle();
  with["attributes"]["TEXCOORD_1"] = b.accessor<float>({0, 0, 1, 0, 0, 1}, "VEC2", 2);
  b.show(with);
  const Scene scene = load(b);
  ASSERT_EQ(scene.mesh.lightmap_uv.size(), 6u);
  EXPECT_TRUE(std::isnan(scene.mesh.lightmap_uv[0].x));
  EXPECT_EQ(scene.mesh.lightmap_uv[4], Vec2(1, 0));
  EXPECT_FALSE(scene.objects[0].has_lightmap_uv);
  EXPECT_TRUE(scene.objects[1].has_lightmap_uv);
}

TEST_F(Geometry, WithoutAnySceneTheRootNodesAreTaken) {
  GltfBuilder b;
  b.show(b.triangle());
  b.json.erase("scenes");
  b.json.erase("scene");
  EXPECT_EQ(load(b).mesh.triangles.size(), 1u);
  EXPECT_TRUE(warned("scenes", "no scene"));
}

}  // namespace
}  // namespace lightwell::scene
