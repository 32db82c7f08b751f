// Probes for moving objects, from the bake to what the runtime makes of them: closed rooms, path tracing at small free facets, walls that no light may pass.
#include <gtest/gtest.h>

#include <cmath>

#include "format/encode/verify.h"
#include "precompute/transport/reference/reference.h"
#include "tests/bake/baked_room.h"
#include "tests/support/door_scenes.h"

namespace lightwell::bake {
namespace {

Vec3 irradianceAbout(const float* sh, const Vec3& normal) {
  const float n[3] = {normal.x, normal.y, normal.z};
  float rgb[3];
  EXPECT_EQ(lw_sh_irradiance(reinterpret_cast<const float(*)[3]>(sh), n, rgb), LW_OK);
  return {rgb[0], rgb[1], rgb[2]};
}

/// A room with a solid box on its floor, whose bottom is left out, of walls in three colours.
void addRoomWithBox(test::SceneBuilder& builder) {
  scene::Material red = test::diffuse(0.6f), green = test::diffuse(0.6f);
  red.base_color = Rgb(0.6f, 0.1f, 0.1f), green.base_color = Rgb(0.1f, 0.5f, 0.1f);
  const uint32_t wall = builder.material(test::diffuse(0.7f)), left = builder.material(red), right = builder.material(green);
  const Vec3 low(-4, -3, -4), high(4, 3, 4), x(8, 0, 0), y(0, 6, 0), z(0, 0, 8);
  builder.quad(low, z, x, wall).quad(low + y, x, z, wall).quad(low, y, z, left).quad(low + x, z, y, right).quad(low, x, y, wall).quad(low + z, y, x, wall);
  const Vec3 bx(2.2f, 0, 0), by(0, 2.5f, 0), bz(0, 0, 2.2f), corner(-1.6f, -3, -1.2f);
  builder.quad(corner + by, bz, bx, wall);
  builder.quad(corner, bz, by, wall).quad(corner + bx, by, bz, wall).quad(corner, by, bx, wall).quad(corner + bz, bx, by, wall);
}
bool isInBox(const Vec3& v) { return v.x > -1.6f && v.x < 0.6f && v.y < -0.5f && v.z > -1.2f && v.z < 1.0f; }

TEST(Probes, AClosedRoomLooksTheSameFromAllSides) {
  for (const float albedo : {0.5f, 0.9f}) {
    BakedRoom room(test::closedBox({2, 1.5f, 3}, test::diffuse(albedo, 1.0f)), lattice(0.8f), 48);
    ASSERT_GT(room.info.probes, 50u);
    const auto sh = room.evaluate();
    const float exact = kPi / (1 - albedo);
    for (uint32_t i = 0; i < room.info.probes; ++i)
      for (int k = 0; k < 27; ++k) {
        const Vec3 way(float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1));
        if (way.length2() == 0) continue;
        ASSERT_NEAR(irradianceAbout(&sh[i * 27], way).x / exact, 1, 0.01) << "probe " << i << ", albedo " << albedo;
      }
    // And between them.
    for (const Vec3& at : {Vec3(0.1f, 0.2f, 0.3f), Vec3(-1.9f, -1.4f, 2.9f), Vec3(1.99f, 0, 0)}) {
      float between[9][3];
      const float position[3] = {at.x, at.y, at.z};
      ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), position, between), LW_OK);
      EXPECT_NEAR(irradianceAbout(&between[0][0], {0, 1, 0}).x / exact, 1, 0.01);
    }
  }
}

TEST(Probes, TheirLightIsThatOfPathTracing) {
  test::SceneBuilder builder;
  addRoomWithBox(builder);
  ProbeSettings settings = lattice(0);
  settings.places.points = {{2.5f, 0.4f, 1}, {-2.9f, -1.1f, 2.2f}, {0, 1.7f, -3}, {-0.5f, 0.3f, 0}, {1.4f, -2.4f, 0.1f}, {3.4f, 2.2f, -3.2f}};
  BakedRoom room(builder.take(), settings, 96);
  const scene::Light lamp = test::pointLight({2, 1, -1}, 10);
  room.shine(lamp);
  const auto sh = room.evaluate();

  // The same room with six small black facets around each of these points.
  test::SceneBuilder with_facets;
  addRoomWithBox(with_facets);
  const uint32_t black = with_facets.material(test::diffuse(0));
  std::vector<Vec3> normals;
  const uint32_t first_facet = 11;
  constexpr float kHalf = 0.01f;
  for (const Vec3& point : settings.places.points)
    for (int side = 0; side < 6; ++side) {
      Vec3 n(0.0f), u(0.0f), v(0.0f);
      n[side / 2] = side % 2 ? -1.0f : 1.0f;
      u[(side / 2 + 1) % 3] = 2 * kHalf;
      v = n.cross(u);
      with_facets.quad(point + n * kHalf - (u + v) * 0.5f, u, v, black);
      normals.push_back(n);
    }
  scene::Scene scene = with_facets.take();
  atlas::Atlas atlas = test::quadAtlas(scene, 1);
  trace::Tracer tracer(scene, 1);
  std::vector<uint32_t> slots;
  for (uint32_t i = 0; i < normals.size(); ++i) slots.push_back(atlas.texel_slot[first_facet + i]);
  const auto reference = transport::referenceIrradianceOf(slots, scene, atlas, tracer, {lamp}, transport::Component::indirect, {.samples = 16384}).irradiance_rgb;
  double difference2 = 0, square = 0, sum = 0, exact = 0;
  for (size_t i = 0; i < slots.size(); ++i) {
    const Vec3 found = irradianceAbout(&sh[i / 6 * 27], normals[i]);
    difference2 += double((found - reference[i]).length2()), square += double(reference[i].length2());
    sum += luminance(found), exact += luminance(reference[i]);
  }
  RecordProperty("relrmse", std::to_string(std::sqrt(difference2 / square)));
  EXPECT_LT(std::sqrt(difference2 / square), 0.05);
  EXPECT_NEAR(sum / exact, 1, 0.02);
}

/// Two rooms side by side with nothing but a double-sided sheet in between, at x = 0.3.
scene::Scene twoRooms(bool solid) {
  test::SceneBuilder builder;
  scene::Material sheet = test::diffuse(0.5f);
  sheet.double_sided = true;
  const uint32_t wall = builder.material(test::diffuse(0.6f));
  if (solid) {
    builder.room({-4, -2, -3}, {0.28f, 2, 3}, wall).room({0.32f, -2, -3}, {4, 2, 3}, wall);
  } else {
    // Floors that end at the sheet: a patch of one floor under both rooms would take light through.
    for (const float begin : {-4.0f, 0.3f}) {
      const Vec3 low(begin, -2, -3), x(begin < 0 ? 4.3f : 3.7f, 0, 0), y(0, 4, 0), z(0, 0, 6);
      builder.quad(low, z, x, wall).quad(low + y, x, z, wall).quad(low, x, y, wall).quad(low + z, y, x, wall);
    }
    builder.quad({-4, -2, -3}, {0, 4, 0}, {0, 0, 6}, wall).quad({4, -2, -3}, {0, 0, 6}, {0, 4, 0}, wall);
    builder.quad({0.3f, -2, -3}, {0, 4, 0}, {0, 0, 6}, builder.material(sheet));
  }
  return builder.take();
}

TEST(Probes, NoLightComesThroughAThinWall) {
  for (const bool solid : {false, true}) {
    BakedRoom room(twoRooms(solid), lattice(1.1f));
    room.shine(test::pointLight({-2, 0, 0}, 1000));
    const auto sh = room.evaluate();
    // The size of what the lit room has.
    float lit[9][3];
    const float far[3] = {-2, 0, 0};
    ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), far, lit), LW_OK);
    ASSERT_GT(irradianceAbout(&lit[0][0], {0, 1, 0}).x, 10.0f);
    for (float gap : {0.04f, 0.1f, 0.3f, 0.6f, 1.0f, 2.0f})
      for (float y = -1.9f; y < 2; y += 0.38f)
        for (float z = -2.9f; z < 3; z += 0.29f) {
          float dark[9][3], bright[9][3];
          const float behind[3] = {0.3f + gap, y, z}, before[3] = {0.3f - gap, y, z};
          ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), behind, dark), LW_OK);
          ASSERT_LT(dark[0][0], 1e-3f * lit[0][0]) << (solid ? "solid" : "sheet") << " gap " << gap << " at " << y << ", " << z;
          ASSERT_EQ(lw_probes_sample(room.loaded, sh.data(), before, bright), LW_OK);
          ASSERT_GT(bright[0][0], 0.5f * lit[0][0]) << (solid ? "solid" : "sheet") << " gap " << gap << " at " << y << ", " << z;
        }
  }
}

TEST(Probes, LightComesThroughADoorAsFarAsItIsOpen) {
  test::DoorOptions options;
  ProbeSettings settings = lattice(1);
  BakedRoom rooms(test::roomsInARow(options), settings, 64);
  const float middle = 1.5f * test::kRoomLength + test::kWallThickness;
  rooms.shine(test::pointLight({1.5f, 1.5f, 0.3f}, 50));
  double dark[3] = {};
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(lw_radiosity_set_portal(rooms.state, 0, 0.5f * float(i)), LW_OK);
    const auto sh = rooms.evaluate();
    float around[9][3];
    const float position[3] = {middle, 1.5f, 0};
    ASSERT_EQ(lw_probes_sample(rooms.loaded, sh.data(), position, around), LW_OK);
    dark[i] = double(around[0][0]);
  }
  EXPECT_LT(dark[0], 1e-3 * dark[2]);
  EXPECT_GT(dark[1], 0.2 * dark[2]);
  EXPECT_LT(dark[1], 0.8 * dark[2]);
}

TEST(Probes, StandInTheOpen) {
  test::SceneBuilder builder;
  addRoomWithBox(builder);
  BakedRoom room(builder.take(), lattice(0.7f));
  const transport::Probes& probes = room.probes.probes;
  EXPECT_GT(probes.inside, 5u);
  EXPECT_GT(probes.moved, 5u);
  EXPECT_EQ(probes.count() + probes.inside + probes.sealed, probes.lattice.size());
  for (uint32_t i = 0; i < probes.count(); ++i) {
    EXPECT_FALSE(isInBox(probes.position[i])) << i;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(room.info.position_m[i * 3 + uint32_t(k)], probes.position[i][k], 1e-5);
  }
}

TEST(Probes, SealedPocketsHaveNone) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.5f));
  builder.room({-4, -3, -4}, {4, 3, 4}, wall).room({1.02f, -0.98f, 1.02f}, {1.98f, 0.98f, 1.98f}, wall);
  // The pocket's outside.
  const Vec3 low(1, -1, 1), x(1, 0, 0), y(0, 2, 0), z(0, 0, 1);
  builder.quad(low, x, z, wall).quad(low + y, z, x, wall).quad(low, z, y, wall).quad(low + x, y, z, wall).quad(low, y, x, wall).quad(low + z, x, y, wall);
  BakedRoom room(builder.take(), lattice(0.8f));
  EXPECT_GT(room.probes.probes.sealed, 0u);
  for (const Vec3& v : room.probes.probes.position) EXPECT_FALSE(v.x > 1 && v.x < 2 && std::abs(v.y) < 1 && v.z > 1 && v.z < 2);
}

TEST(Probes, BytesDependNeitherOnThreadsNorOnHowTheyAreCut) {
  test::SceneBuilder a, b;
  addRoomWithBox(a), addRoomWithBox(b);
  ProbeSettings settings = lattice(1.3f);
  settings.links.rays = 256;
  BakedRoom one(a.take(), settings, 32, 17, 1), other(b.take(), settings, 32, 200, 3);
  EXPECT_EQ(one.places, other.places);
  EXPECT_EQ(one.file, other.file);
  EXPECT_TRUE(format::verify(format::memorySource(one.file.data(), one.file.size())).empty());
}

TEST(Probes, TheAutomaticLatticeKeepsToItsBudget) {
  for (const Vec3& half : {Vec3(4, 3, 5), Vec3(60, 2, 40), Vec3(5, 0, 5), Vec3(0.1f, 50, 0.1f)}) {
    const transport::ProbeLattice lattice = transport::makeProbeLattice(Box3(-half, half), {.budget = 1000}, 1);
    EXPECT_LE(lattice.size(), 1000u);
    EXPECT_GT(lattice.size(), 400u);
    for (int k = 0; k < 3; ++k) EXPECT_LE(std::abs(lattice.first[k] + half[k] - 0.5f * lattice.spacing), 0.51f * lattice.spacing);
  }
  EXPECT_EQ(transport::makeProbeLattice(Box3({-1, -1, -1}, {1, 1, 1}), {}, 1).size(), 0u);
  EXPECT_THROW(transport::makeProbeLattice(Box3({-1, -1, -1}, {1, 1, 1}), {.spacing = 1e-4f}, 1), UsageError);
}

/// A sphere of small tiles.
void addSphere(test::SceneBuilder& builder, const Vec3& center, float radius, uint32_t material) {
  constexpr int kTiles = 14;
  for (int face = 0; face < 6; ++face)
    for (int j = 0; j < kTiles; ++j)
      for (int i = 0; i < kTiles; ++i) {
        const auto point = [&](float u, float v) {
          Vec3 p;
          p[face / 2] = face % 2 ? -1.0f : 1.0f;
          p[(face / 2 + 1) % 3] = std::tan((2 * u / kTiles - 1) * kPi / 4);
          p[(face / 2 + 2) % 3] = std::tan((2 * v / kTiles - 1) * kPi / 4) * p[face / 2];
          return p.normalized();
        };
        const auto u = float(i), v = float(j);
        // A little larger than the cell, so that there are no gaps.
        const Vec3 edge_s = (point(u + 1.05f, v + 0.5f) - point(u - 0.05f, v + 0.5f)) * radius, edge_t = (point(u + 0.5f, v + 1.05f) - point(u + 0.5f, v - 0.05f)) * radius;
        builder.quad(center + point(u + 0.5f, v + 0.5f) * radius - (edge_s + edge_t) * 0.5f, edge_s, edge_t, material);
      }
}

TEST(Blockers, ABlackBallOnTheFloorTakesWhatPathTracingSays) {
  // A room lit by its ceiling and by lamps whose first reflection fills it.
  const Vec3 center(0.4f, -1, 0.2f);
  constexpr float kRadius = 0.5f;
  const auto room = [](test::SceneBuilder& builder) {
    const uint32_t wall = builder.material(test::diffuse(0.7f)), ceiling = builder.material(test::diffuse(0.5f, 1));
    const Vec3 low(-2, -1.5f, -2), x(4, 0, 0), y(0, 3, 0), z(0, 0, 4);
    builder.quad(low, z, x, wall).quad(low + y, x, z, ceiling).quad(low, y, z, wall).quad(low + x, z, y, wall).quad(low, x, y, wall).quad(low + z, y, x, wall);
  };
  test::SceneBuilder empty, with_ball;
  room(empty), room(with_ball);
  BakedRoom baked(empty.take(), lattice(2), 96);
  const lw_blocker ball{{center.x, center.y, center.z}, kRadius, {0, 0, 0}};
  ASSERT_EQ(lw_radiosity_set_blockers(baked.state, &ball, 1), LW_OK);
  ASSERT_EQ(lw_radiosity_solve(baked.state, 1e-6, 200, nullptr), LW_OK);
  std::vector<float> atlas(size_t(baked.p.atlas.width) * size_t(baked.p.atlas.height) * 4);
  lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
  ASSERT_EQ(lw_radiosity_shade(baked.state, &shading, atlas.data()), LW_OK);

  addSphere(with_ball, center, kRadius, with_ball.material(test::diffuse(0)));
  const scene::Scene scene = with_ball.take();
  const trace::Tracer tracer(scene, 1);
  // The same texels in both: those of the floor.
  std::vector<uint32_t> slots;
  for (uint32_t i = 0; i < baked.p.atlas.slots.size(); ++i)
    if (baked.p.scene.mesh.triangle_object[baked.p.atlas.patches[baked.p.atlas.slots[i].first_patch].triangle] == 0) slots.push_back(i);
  const atlas::Atlas& floor = baked.p.atlas;
  const auto reference = transport::referenceIrradianceOf(slots, scene, floor, tracer, {}, transport::Component::total, {.samples = 512}).irradiance_rgb;
  double difference2 = 0, square = 0, sum = 0, exact = 0;
  for (size_t i = 0; i < slots.size(); ++i) {
    const atlas::Slot& slot = floor.slots[slots[i]];
    const float position[3] = {slot.position.x, slot.position.y, slot.position.z}, normal[3] = {0, 1, 0};
    float kept[3];
    ASSERT_EQ(lw_blockers_kept(&ball, 1, position, normal, kept), LW_OK);
    const double e = double(atlas[size_t(slot.texel) * 4]) * double(kept[0]), r = double(reference[i].x);
    difference2 += (e - r) * (e - r), square += r * r, sum += e, exact += r;
  }
  RecordProperty("relrmse", std::to_string(std::sqrt(difference2 / square)));
  EXPECT_LT(std::sqrt(difference2 / square), 0.08);
  EXPECT_NEAR(sum / exact, 1, 0.04);
}

}  // namespace
}  // namespace lightwell::bake
