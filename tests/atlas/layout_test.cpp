// Light-map coordinates: which are kept, which are generated, and how they lie in the atlas.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "precompute/atlas/atlas.h"
#include "precompute/atlas/uv_check.h"
#include "tests/atlas/scene_builder.h"

namespace lightwell::atlas {
namespace {

using test::SceneBuilder;
using test::surfaceArea;
using testing::HasSubstr;

struct Built {
  scene::Scene scene;
  Atlas atlas;
  std::vector<Warning> warnings;
};

Built build(const scene::Scene& given, int size, int padding = 2, int threads = 1) {
  Built built{given, {}, {}};
  Diagnostics diagnostics;
  AtlasOptions options;
  options.size = size;
  options.padding_texels = padding;
  built.atlas = buildAtlas(built.scene, options, diagnostics, threads);
  built.warnings = diagnostics.warnings();
  return built;
}

/// Least number of uncovered texels between texels of different charts, looking along rows, columns and diagonals.
int leastGap(const Atlas& atlas, int most) {
  const auto chart = [&](int x, int y) {
    const uint32_t slot = atlas.texel_slot[size_t(y) * atlas.width + x];
    return slot == kNone ? kNone : atlas.slots[slot].chart;
  };
  int least = most;
  for (int y = 0; y < atlas.height; ++y)
    for (int x = 0; x < atlas.width; ++x)
      for (int dy = -most; dy <= most && chart(x, y) != kNone; ++dy)
        for (int dx = -most; dx <= most; ++dx) {
          if (x + dx < 0 || x + dx >= atlas.width || y + dy < 0 || y + dy >= atlas.height) continue;
          const uint32_t other = chart(x + dx, y + dy);
          if (other != kNone && other != chart(x, y)) least = std::min(least, std::max(std::abs(dx), std::abs(dy)) - 1);
        }
  return least;
}

/// The result's own coordinates, checked as if they had been given.
UvCheck recheck(const Built& built) {
  scene::Scene scene = built.scene;
  scene.mesh.lightmap_uv = built.atlas.uv;
  for (scene::Object& object : scene.objects) object.has_lightmap_uv = true;
  return checkLightmapUv(scene, built.atlas.width, built.atlas.height);
}

double slotArea(const Atlas& atlas) {
  double area = 0;
  for (const Slot& slot : atlas.slots) area += slot.area;
  return area;
}

/// A tessellated height field or tube: point(i / n, j / m) over an n × m grid with shared vertices.
template <class Point>
scene::Scene grid(int n, int m, Point point) {
  scene::Scene scene = SceneBuilder().object(false).build();
  scene::Mesh& mesh = scene.mesh;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      mesh.positions.push_back(point(float(i) / float(n), float(j) / float(m)));
      mesh.normals.push_back(Vec3(0, 1, 0));
      scene.bounds.extendBy(mesh.positions.back());
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const uint32_t a = uint32_t(j * (n + 1) + i), b = a + 1, c = a + uint32_t(n) + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  mesh.triangle_material.assign(mesh.triangles.size(), 0);
  mesh.triangle_object.assign(mesh.triangles.size(), 0);
  scene.objects[0].triangle_count = uint32_t(mesh.triangles.size());
  scene.objects[0].vertex_count = uint32_t(mesh.positions.size());
  return scene;
}

SceneBuilder twoQuads() {
  SceneBuilder builder;
  builder.object(true).quad({0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0}, {0.5f, 1});
  builder.object(true).quad({0, 0, 4}, {4, 0, 0}, {0, 4, 0}, {0.5f, 0}, {1, 1});
  return builder;
}

TEST(GivenUv, SoundCoordinatesAreKeptBitForBit) {
  const scene::Scene given = twoQuads().build();
  for (int size : {16, 17, 1}) {
    const Built built = build(given, size);
    EXPECT_FALSE(built.atlas.unwrapped);
    EXPECT_TRUE(built.warnings.empty());
    EXPECT_EQ(built.atlas.uv, given.mesh.lightmap_uv);
    EXPECT_EQ(built.scene.mesh.triangles, given.mesh.triangles);
    EXPECT_EQ(built.atlas.chart_count, size == 1 ? 1u : 2u);
  }
}

TEST(GivenUv, EveryProblemIsFoundAndNamed) {
  struct Case {
    const char* reason;
    std::function<void(std::vector<Vec2>&)> spoil;
  };
  const Case cases[] = {
      {"not finite", [](auto& uv) { uv[5].x = NAN; }},
      {"outside [0, 1]", [](auto& uv) { uv[5].x = 1.02f; }},
      {"outside [0, 1]", [](auto& uv) { uv[5].y = -0.01f; }},
      {"collapsed", [](auto& uv) { for (int i = 4; i < 8; ++i) uv[i] = Vec2(0.75f, 0.5f); }},
      {"overlapping itself", [](auto& uv) { uv[7] = Vec2(0.9f, 0.1f); }},  // folded over the quad's diagonal
      {"overlapping that of another", [](auto& uv) { for (int i = 4; i < 8; ++i) uv[i].x -= 0.1f; }},
  };
  for (const Case& c : cases) {
    scene::Scene given = twoQuads().build();
    c.spoil(given.mesh.lightmap_uv);
    const Built built = build(given, 64);
    EXPECT_TRUE(built.atlas.unwrapped);
    ASSERT_FALSE(built.warnings.empty()) << c.reason;
    EXPECT_EQ(built.warnings[0].place, "nodes[1]") << c.reason;
    EXPECT_THAT(built.warnings[0].message, HasSubstr(c.reason));
    for (const UvProblem problem : recheck(built).problem) EXPECT_EQ(problem, UvProblem::none) << c.reason;
  }
}

TEST(GivenUv, SharedBorderTexelsAreNoOverlap) {
  // Strips that meet inside texels at every size that is no multiple of 20.
  SceneBuilder builder;
  for (int i = 0; i < 20; ++i)
    builder.object(true).quad({float(i), 0, 0}, {1, 0, 0}, {0, 1, 0}, {float(i) / 20, 0}, {float(i + 1) / 20, 1});
  for (int size : {1, 3, 13, 64, 99}) EXPECT_TRUE(build(builder.build(), size).warnings.empty()) << size;
}

TEST(GivenUv, ObjectsWithoutCoordinatesGoIntoFreeSpace) {
  // The free space lies on the right of and below the given coordinates, then on the left of and above them.
  for (const float low : {0.0f, 0.4f}) {
    SceneBuilder builder;
    builder.object(true).quad({0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {low, low}, {low + 0.6f, low + 0.6f});
    builder.object(false).box({1, 1, 1}, {2, 3, 4});
    const scene::Scene given = builder.build();
    const Built built = build(given, 64);
    EXPECT_TRUE(built.atlas.unwrapped);
    ASSERT_EQ(built.warnings.size(), 1u);
    EXPECT_THAT(built.warnings[0].message, HasSubstr("missing"));
    for (int v = 0; v < 4; ++v) EXPECT_EQ(built.atlas.uv[v], given.mesh.lightmap_uv[v]);
    EXPECT_EQ(built.atlas.chart_count, 7u);
    EXPECT_GE(leastGap(built.atlas, 4), 2);
    EXPECT_NEAR(slotArea(built.atlas) / surfaceArea(given.mesh), 1, 1e-4);
  }
}

TEST(GivenUv, WithoutFreeSpaceEverythingIsUnwrapped) {
  SceneBuilder builder;
  builder.object(true).quad({0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0}, {1, 1});
  builder.object(false).box({1, 1, 1}, {2, 3, 4});
  const Built built = build(builder.build(), 64);
  ASSERT_EQ(built.warnings.size(), 2u);
  EXPECT_THAT(built.warnings[1].message, HasSubstr("all light-map coordinates were generated anew"));
  EXPECT_GE(leastGap(built.atlas, 4), 2);
}

TEST(Unwrap, BoxHasSixChartsOfOneDensityApartByThePadding) {
  const scene::Scene given = SceneBuilder().object(false).box({0, 0, 0}, {4, 2, 1}).build();
  for (int padding : {0, 1, 2, 5}) {
    const Built built = build(given, 128, padding);
    EXPECT_EQ(built.atlas.chart_count, 6u);
    EXPECT_GE(leastGap(built.atlas, padding + 2), padding);
    EXPECT_NEAR(slotArea(built.atlas), 28, 1e-3);
    // One density: every texel holds about the same area.
    const double mean = 28.0 / double(built.atlas.slots.size());
    for (const Slot& slot : built.atlas.slots) EXPECT_NEAR(slot.area / mean, 1, 0.1);
    EXPECT_GT(built.atlas.slots.size(), 128u * 128u / 2);
  }
}

TEST(Unwrap, SeamsDuplicateVerticesAndLeaveTheSurfaceAlone) {
  // A tube with shared vertices must be cut along its length at least.
  const scene::Scene given = grid(32, 4, [](float s, float t) {
    const float angle = 2 * kPi * s;
    return Vec3(std::cos(angle), 4 * t, -std::sin(angle));
  });
  const Built built = build(given, 64);
  const scene::Mesh &before = given.mesh, &after = built.scene.mesh;
  EXPECT_GT(after.positions.size(), before.positions.size());
  EXPECT_EQ(after.positions.size(), built.atlas.uv.size());
  EXPECT_EQ(after.normals.size(), after.positions.size());
  EXPECT_EQ(built.scene.objects[0].vertex_count, after.positions.size());
  ASSERT_EQ(after.triangles.size(), before.triangles.size());
  for (size_t t = 0; t < after.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(after.positions[after.triangles[t][k]], before.positions[before.triangles[t][k]]);
  EXPECT_LE(built.atlas.chart_count, 6u);
  for (const UvProblem problem : recheck(built).problem) EXPECT_EQ(problem, UvProblem::none);
}

TEST(Unwrap, ARampThatPassesOverItselfIsCut) {
  // Three turns of a spiral ramp face up everywhere and connect, yet lie over each other when projected.
  const scene::Scene given = grid(300, 4, [](float s, float t) {
    const float angle = 6 * kPi * s, radius = 2 + 2 * t;
    return Vec3(radius * std::sin(angle), 3 * s, radius * std::cos(angle));
  });
  const Built built = build(given, 256);
  EXPECT_GE(built.atlas.chart_count, 3u);
  EXPECT_LE(built.atlas.chart_count, 12u);
  for (const UvProblem problem : recheck(built).problem) EXPECT_EQ(problem, UvProblem::none);
  EXPECT_GE(leastGap(built.atlas, 4), 2);
}

TEST(Unwrap, ChartsKeepWithinTheNormalDeviation) {
  const scene::Scene sphere = grid(48, 24, [](float s, float t) {
    const float phi = 2 * kPi * s, theta = kPi * (0.02f + 0.96f * t);
    return Vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)) * 4.0f;
  });
  const Built built = build(sphere, 128);
  std::vector<std::vector<Vec3>> normals(built.atlas.chart_count);
  for (const Slot& slot : built.atlas.slots)
    for (uint32_t i = 0; i < slot.patch_count; ++i) {
      const uint32_t triangle = built.atlas.patches[slot.first_patch + i].triangle;
      normals[slot.chart].push_back(surfacePoint(built.scene.mesh, triangle, 0.3f, 0.3f).geometric_normal);
    }
  for (const auto& of_chart : normals)
    for (const Vec3& n : of_chart) EXPECT_GT(n.dot(of_chart[0]), std::cos(0.7f + 1.05f) - 1e-3f);
  EXPECT_NEAR(slotArea(built.atlas) / surfaceArea(sphere.mesh), 1, 1e-4);
}

TEST(Unwrap, ManyTinyPartsBesideAGiantFit) {
  SceneBuilder builder;
  builder.object(false).quad({0, 0, 0}, {10, 0, 0}, {0, 10, 0});
  std::mt19937 random(5);
  std::uniform_real_distribution<float> place(0, 10);
  builder.object(false);
  for (int i = 0; i < 500; ++i) {
    const Vec3 low(place(random), place(random), place(random));
    builder.box(low, low + Vec3(1e-3f));
  }
  const Built built = build(builder.build(), 256);
  EXPECT_NEAR(slotArea(built.atlas) / surfaceArea(built.scene.mesh), 1, 1e-4);
  size_t giant = 0;
  for (const Slot& slot : built.atlas.slots) giant += slot.position.z == 0 && slot.area > 1e-4f;
  EXPECT_GT(giant, 256u * 256u / 2) << "the crumbs took the atlas";
}

TEST(Unwrap, TellsTheSmallestAtlasThatWouldDo) {
  const scene::Scene given = SceneBuilder().object(false).box({0, 0, 0}, {1, 1, 1}).build();
  try {
    build(given, 1);
    FAIL() << "six charts cannot fit into one texel";
  } catch (const InputError& error) {
    EXPECT_EQ(error.file, "test.glb");
    EXPECT_THAT(error.reason, HasSubstr("smallest size that would do is 3"));
  }
  EXPECT_NEAR(slotArea(build(given, 3).atlas), 6, 1e-4);
}

TEST(Unwrap, RefusesSizesOutOfRange) {
  const scene::Scene given = SceneBuilder().object(false).box({0, 0, 0}, {1, 1, 1}).build();
  for (int size : {0, -5, 8193}) EXPECT_THROW(build(given, size), UsageError);
}

TEST(Unwrap, IsTheSameForAnyNumberOfThreads) {
  SceneBuilder builder;
  for (int i = 0; i < 30; ++i) builder.object(false).box(Vec3(float(i)), Vec3(float(i) + 1 + float(i % 3)));
  const Built one = build(builder.build(), 256, 2, 1), four = build(builder.build(), 256, 2, 4);
  EXPECT_EQ(one.atlas.uv, four.atlas.uv);
  EXPECT_EQ(one.atlas.texel_slot, four.atlas.texel_slot);
  EXPECT_EQ(one.scene.mesh.triangles, four.scene.mesh.triangles);
  for (size_t i = 0; i < one.atlas.slots.size(); ++i) ASSERT_EQ(one.atlas.slots[i].position, four.atlas.slots[i].position);
}

}  // namespace
}  // namespace lightwell::atlas
