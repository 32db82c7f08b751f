// EXT_meshopt_compression and KHR_draco_mesh_compression: what was encoded comes back, and damage is an error.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <meshoptimizer.h>

#include "precompute/core/error.h"
#include "precompute/core/random.h"
#include "tests/scene/gltf_builder.h"

namespace lightwell::scene {
namespace {

using testing::HasSubstr;
using Compression = SceneTest;

/// A bumpy n × n grid.
struct Grid {
  std::vector<float> positions;
  std::vector<uint32_t> indices;
  explicit Grid(uint32_t n) {
    for (uint32_t y = 0; y < n; ++y)
      for (uint32_t x = 0; x < n; ++x) positions.insert(positions.end(), {float(x), float(y), float((x * 7 + y * 13) % 5) * 0.25f});
    for (uint32_t y = 0; y + 1 < n; ++y)
      for (uint32_t x = 0; x + 1 < n; ++x) {
        const uint32_t i = y * n + x;
        indices.insert(indices.end(), {i, i + 1, i + n, i + n, i + 1, i + n + 1});
      }
  }
};

size_t compressedView(GltfBuilder& b, const std::vector<unsigned char>& data, const char* mode, size_t count, size_t stride) {
  const size_t source = b.view(data);
  Json extension = b.json["bufferViews"][source];
  extension["mode"] = mode;
  extension["count"] = count;
  extension["byteStride"] = stride;
  b.json["bufferViews"].erase(source);
  // The fallback buffer has no data, as exporters leave it.
  return b.add("bufferViews", {{"buffer", 1}, {"byteLength", count * stride}, {"extensions", {{"EXT_meshopt_compression", extension}}}});
}

GltfBuilder meshoptScene(const Grid& grid) {
  GltfBuilder b;
  b.useExtension("EXT_meshopt_compression", true);
  const size_t vertex_count = grid.positions.size() / 3, index_count = grid.indices.size();
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(vertex_count, 12));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), grid.positions.data(), vertex_count, 12));
  std::vector<unsigned char> indices(meshopt_encodeIndexBufferBound(index_count, vertex_count));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), grid.indices.data(), index_count));
  const size_t vertex_view = compressedView(b, vertices, "ATTRIBUTES", vertex_count, 12);
  const size_t index_view = compressedView(b, indices, "TRIANGLES", index_count, 4);
  b.show({{"attributes", {{"POSITION", b.accessorOfView(vertex_view, vertex_count, "VEC3", 5126)}}},
          {"indices", b.accessorOfView(index_view, index_count, "SCALAR", 5125)}});
  b.json["buffers"] = {{{"byteLength", b.binary.size()}},
                       {{"byteLength", 1 << 20}, {"extensions", {{"EXT_meshopt_compression", {{"fallback", true}}}}}}};
  return b;
}

GltfBuilder dracoScene(const Grid& grid, int speed) {
  GltfBuilder b;
  b.useExtension("KHR_draco_mesh_compression", true);
  draco::TriangleSoupMeshBuilder soup;
  soup.Start(int(grid.indices.size() / 3));
  const int attribute = soup.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (size_t f = 0; f < grid.indices.size() / 3; ++f)
    soup.SetAttributeValuesForFace(attribute, draco::FaceIndex(uint32_t(f)), &grid.positions[grid.indices[3 * f] * 3],
                                   &grid.positions[grid.indices[3 * f + 1] * 3], &grid.positions[grid.indices[3 * f + 2] * 3]);
  const auto mesh = soup.Finalize();
  draco::Encoder encoder;
  encoder.SetSpeedOptions(speed, speed);  // 10: sequential; lower: edgebreaker
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  const size_t view = b.view(buffer.data(), buffer.size());
  const size_t position = b.add("accessors", {{"count", encoder.num_encoded_points() ? encoder.num_encoded_points() : mesh->num_points()},
                                              {"type", "VEC3"}, {"componentType", 5126}});
  const size_t indices = b.add("accessors", {{"count", grid.indices.size()}, {"type", "SCALAR"}, {"componentType", 5125}});
  const Json extension = {{"bufferView", view}, {"attributes", {{"POSITION", mesh->attribute(attribute)->unique_id()}}}};
  b.show({{"attributes", {{"POSITION", position}}}, {"indices", indices}, {"extensions", {{"KHR_draco_mesh_compression", extension}}}});
  return b;
}

GltfBuilder plainScene(const Grid& grid) {
  GltfBuilder b;
  b.show({{"attributes", {{"POSITION", b.accessor(grid.positions, "VEC3", 3)}}}, {"indices", b.accessor(grid.indices, "SCALAR", 1)}});
  return b;
}

/// The same triangles in any order: equal sums of their centroids and areas.
void expectSameSurface(const Scene& a, const Scene& b) {
  ASSERT_EQ(a.mesh.triangles.size(), b.mesh.triangles.size());
  EXPECT_EQ(a.metres_per_unit, b.metres_per_unit);
  const auto moments = [](const Scene& scene) {
    Vec3d centroid(0);
    double area = 0;
    for (const auto& t : scene.mesh.triangles) {
      const Vec3d p(scene.mesh.positions[t[0]]), q(scene.mesh.positions[t[1]]), r(scene.mesh.positions[t[2]]);
      const double triangle_area = (q - p).cross(r - p).length();
      centroid += (p + q + r) * triangle_area;
      area += triangle_area;
    }
    return std::make_pair(centroid / area, area);
  };
  const auto [centroid_a, area_a] = moments(a);
  const auto [centroid_b, area_b] = moments(b);
  EXPECT_LT((centroid_a - centroid_b).length(), 1e-4);
  EXPECT_NEAR(area_a / area_b, 1, 1e-5);
}

TEST_F(Compression, MeshoptGivesTheSameSurface) {
  const Grid grid(20);
  const Scene plain = load(plainScene(grid));
  expectSameSurface(plain, load(meshoptScene(grid)));
}

TEST_F(Compression, DracoGivesTheSameSurface) {
  const Grid grid(20);
  const Scene plain = load(plainScene(grid));
  for (const int speed : {10, 0}) expectSameSurface(plain, load(dracoScene(grid, speed)));
}

/// Attributes that the Draco mesh does not hold come from accessors, and these may be sparse, without anything to be sparse in.
TEST_F(Compression, DracoBesideSparseAccessors) {
  GltfBuilder b = dracoScene(Grid(5), 10);
  const size_t vertices = b.json["accessors"][0]["count"];
  const size_t indices = b.view(std::vector<uint16_t>{1}), values = b.view(std::vector<float>{0, 0.5f, 1});
  const Json sparse = {{"count", 1}, {"indices", {{"bufferView", indices}, {"componentType", 5123}}}, {"values", {{"bufferView", values}}}};
  const auto accessor = [&](const Json& of) { return b.add("accessors", {{"count", vertices}, {"type", "VEC3"}, {"componentType", 5126}, {"sparse", of}}); };
  b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor(sparse);
  const Scene scene = load(b);
  ASSERT_EQ(scene.mesh.colors.size(), scene.mesh.positions.size());
  expectSameSurface(load(plainScene(Grid(5))), scene);
  size_t coloured = 0;
  for (const auto& color : scene.mesh.colors) coloured += color[1] == 0.5f && color[2] == 1;
  EXPECT_GT(coloured, 0u);
  EXPECT_LT(coloured, 10u);
  Json past = sparse;
  past["count"] = 2;
  b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor(past);
  EXPECT_THAT(errorOf(b), HasSubstr("attributes.COLOR_0: "));
}

TEST_F(Compression, DamagedMeshoptNamesTheView) {
  GltfBuilder b = meshoptScene(Grid(5));
  b.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["byteLength"] = 20;
  EXPECT_THAT(errorOf(b), HasSubstr("bufferViews[0].extensions.EXT_meshopt_compression: the compressed data is damaged"));
}

TEST_F(Compression, AbsurdMeshoptCountsAreRefusedBeforeTheyAreAllocated) {
  GltfBuilder b = meshoptScene(Grid(5));
  b.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"] = 4'000'000'000;
  EXPECT_THAT(errorOf(b), HasSubstr("EXT_meshopt_compression.count: is more than"));
}

TEST_F(Compression, DracoThatContradictsItsAccessorsIsRefused) {
  GltfBuilder b = dracoScene(Grid(5), 0);
  b.json["accessors"][0]["count"] = 7;
  EXPECT_THAT(errorOf(b), HasSubstr("meshes[0].primitives[0].attributes.POSITION: declares 7 elements"));
  b = dracoScene(Grid(5), 0);
  b.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] = 99;
  EXPECT_THAT(errorOf(b), HasSubstr("KHR_draco_mesh_compression.attributes.POSITION: the compressed mesh has no such attribute"));
}

/// Flipped bytes either change the surface or are refused; nothing else may happen.
TEST_F(Compression, DamagedBytesNeverCrash) {
  const Grid grid(12);
  for (const GltfBuilder& original : {meshoptScene(grid), dracoScene(grid, 0), dracoScene(grid, 10)}) {
    for (uint32_t round = 0; round < 100; ++round) {
      GltfBuilder damaged = original;
      for (uint32_t i = 0; i <= round % 3; ++i) {
        const uint32_t hash = mixBits(combineKeys(round, i));
        damaged.binary[hash % damaged.binary.size()] ^= uint8_t(1u << (hash >> 29));
      }
      try {
        const Scene scene = load(damaged);
        for (const Vec3& p : scene.mesh.positions) ASSERT_TRUE(isFinite(p));
        for (const Vec3& n : scene.mesh.normals) ASSERT_NEAR(n.length(), 1, 1e-4);
      } catch (const InputError&) {
      }
    }
  }
}

}  // namespace
}  // namespace lightwell::scene
