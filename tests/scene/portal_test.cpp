// Doors and shutters: which nodes they are, and along which axis they open.
#include <gmock/gmock.h>

#include "precompute/core/error.h"
#include "tests/scene/gltf_builder.h"

namespace lightwell::scene {
namespace {

using testing::HasSubstr;

class PortalTest : public SceneTest {
 protected:
  /// A room of one triangle, and a leaf 2 m wide, 3 m high and 0.1 m thick as a node of its own. Returns the leaf's node.
  size_t build(GltfBuilder& b) {
    b.show(b.triangle());
    const std::vector<float> corners = {-1, 0, 0, 1, 0, 0, 1, 3, 0, -1, 3, 0, -1, 0, 0.1f, 1, 0, 0.1f, 1, 3, 0.1f, -1, 3, 0.1f};
    Json primitive = {{"attributes", {{"POSITION", b.accessor<float>(corners, "VEC3", 3)}}},
                      {"indices", b.accessor<uint16_t>({0, 2, 1, 0, 3, 2, 4, 5, 6, 4, 6, 7}, "SCALAR", 1)}};
    const size_t leaf = b.show(primitive);
    b.json["nodes"][leaf]["name"] = "door_1";
    return leaf;
  }
  Scene loadNamed(const GltfBuilder& b, std::vector<std::string> names) {
    return importGltf(b.writeGlb(folder / "scene.glb"), {.portals = std::move(names)}, diagnostics);
  }
};

TEST_F(PortalTest, AreMarkedByExtrasAndOpenAlongTheirWidth) {
  GltfBuilder b;
  const size_t leaf = build(b);
  b.json["nodes"][leaf]["extras"] = {{"lightwell", {{"portal", true}}}};
  const Scene scene = load(b);
  ASSERT_EQ(scene.portals.size(), 1u);
  const Portal& portal = scene.portals[0];
  EXPECT_EQ(portal.name, "door_1");
  EXPECT_EQ(portal.strips, 8u);
  EXPECT_EQ(portal.first_triangle, 1u);
  EXPECT_EQ(portal.triangle_count, 4u);
  for (uint32_t v = 3; v < scene.mesh.positions.size(); ++v)
    EXPECT_NEAR(portal.place(scene.mesh.positions[v]), worldPosition(scene, v).x < 0 ? 0 : 1, 1e-5);
  EXPECT_EQ(portal.strip(scene.mesh.positions[3]), 0u);
  EXPECT_EQ(portal.strip(scene.mesh.positions[4]), 7u);
}

TEST_F(PortalTest, OpenAlongTheLocalAxisThatTheyName) {
  GltfBuilder b;
  const size_t leaf = build(b);
  b.json["nodes"][leaf]["rotation"] = {0, std::sqrt(0.5), 0, std::sqrt(0.5)};  // its x is the world's −z
  b.json["nodes"][leaf]["extras"] = {{"lightwell", {{"portal", {{"strips", 3}, {"opens_along", {-2, 0, 0}}}}}}};
  const Scene turned = load(b);
  ASSERT_EQ(turned.portals.size(), 1u);
  EXPECT_EQ(turned.portals[0].strips, 3u);
  for (uint32_t v = 3; v < turned.mesh.positions.size(); ++v)
    EXPECT_NEAR(turned.portals[0].place(turned.mesh.positions[v]), worldPosition(turned, v).z < 0 ? 0 : 1, 1e-5);
  b.json["nodes"][leaf]["extras"]["lightwell"]["portal"] = {{"opens_along", {0, 1, 0}}};
  const Scene shutter = load(b);
  for (uint32_t v = 3; v < shutter.mesh.positions.size(); ++v)
    EXPECT_NEAR(shutter.portals[0].place(shutter.mesh.positions[v]), worldPosition(shutter, v).y < 1 ? 0 : 1, 1e-5);
}

TEST_F(PortalTest, FollowALeafThatStandsAskew) {
  GltfBuilder b;
  const size_t leaf = build(b);
  b.json["nodes"][leaf]["rotation"] = {0, std::sin(0.25), 0, std::cos(0.25)};
  b.json["nodes"][leaf]["extras"] = {{"lightwell", {{"portal", true}}}};
  const Portal portal = load(b).portals.at(0);
  EXPECT_NEAR(std::abs(portal.axis.normalized().dot(Vec3(std::cos(0.5f), 0, -std::sin(0.5f)))), 1, 1e-4);
  EXPECT_GT(portal.axis.x, 0);
}

TEST_F(PortalTest, HoldWhatHangsOnTheirNode) {
  GltfBuilder b;
  const size_t leaf = build(b);
  const size_t handle = b.add("nodes", {{"mesh", 0}, {"name", "handle"}});
  b.json["nodes"][leaf]["children"] = {handle};
  const Scene scene = loadNamed(b, {"door_*", "handle"});
  ASSERT_EQ(scene.portals.size(), 1u);
  EXPECT_EQ(scene.portals[0].triangle_count, 5u);
}

TEST_F(PortalTest, AreNamedByTheCaller) {
  GltfBuilder b;
  build(b);
  EXPECT_EQ(load(b).portals.size(), 0u);
  EXPECT_EQ(loadNamed(b, {"door_1"}).portals.size(), 1u);
  EXPECT_EQ(loadNamed(b, {"do*"}).portals.size(), 1u);
  try {
    loadNamed(b, {"gate"});
    FAIL() << "an unknown name was taken";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("\"gate\""));
    EXPECT_THAT(error.what(), HasSubstr("door_1"));
  }
}

TEST_F(PortalTest, ThatCannotBeMeantAreRefused) {
  GltfBuilder b;
  const size_t leaf = build(b);
  const auto errorWith = [&](Json portal) {
    b.json["nodes"][leaf]["extras"] = {{"lightwell", {{"portal", std::move(portal)}}}};
    return errorOf(b);
  };
  const std::string place = "nodes[1].extras.lightwell.portal";
  EXPECT_THAT(errorWith(3), HasSubstr(place));
  EXPECT_THAT(errorWith({{"strips", 0}}), HasSubstr(place + ".strips"));
  EXPECT_THAT(errorWith({{"strips", 257}}), HasSubstr(place + ".strips"));
  EXPECT_THAT(errorWith({{"opens_along", {0, 0, 0}}}), HasSubstr(place + ".opens_along"));
  EXPECT_THAT(errorWith({{"opens_along", "x"}}), HasSubstr(place + ".opens_along"));
  b.json["nodes"][leaf]["extras"] = "what other programs write";
  EXPECT_EQ(load(b).portals.size(), 0u);
  b.json["nodes"][leaf]["extras"] = {{"lightwell", {{"portal", {{"stripes", 4}}}}}};
  EXPECT_EQ(load(b).portals.size(), 1u);
  EXPECT_TRUE(warned(place + ".stripes", "means nothing"));
  b.json["nodes"][leaf].erase("mesh");
  EXPECT_EQ(load(b).portals.size(), 0u);
  EXPECT_TRUE(warned("nodes[1]", "no portal"));
}

}  // namespace
}  // namespace lightwell::scene
