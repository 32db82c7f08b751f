// Which texel's value each texel shows: gutters, buried texels.
#include <gtest/gtest.h>

#include "precompute/atlas/sources.h"
#include "precompute/atlas/validity.h"
#include "tests/atlas/scene_builder.h"

namespace lightwell::atlas {
namespace {

using test::SceneBuilder;

Atlas build(scene::Scene& scene, int size) {
  Diagnostics diagnostics;
  AtlasOptions options;
  options.size = size;
  return buildAtlas(scene, options, diagnostics, 1);
}

long distance2(const Atlas& atlas, uint32_t a, uint32_t b) {
  const long w = atlas.width, dx = long(a % w) - long(b % w), dy = long(a / w) - long(b / w);
  return dx * dx + dy * dy;
}

/// A floor of one texel per unit, and a box of the given material that stands through it. Built in internal units as they come.
scene::Scene boxThroughFloor(bool double_sided) {
  SceneBuilder builder;
  builder.scene().materials.resize(2);
  builder.scene().materials[1].double_sided = double_sided;
  builder.object(true).quad({0, 0, 0}, {0, 0, 16}, {16, 0, 0}, {0, 0}, {0.5f, 0.5f});  // faces +y; u along z, v along x
  builder.object(false, 1).box({4, -1, 4}, {10, 2, 10});
  return builder.build();
}

TEST(Gutters, ShowTheNearestCoveredTexel) {
  SceneBuilder builder;
  builder.object(true).triangle({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0.1f, 0.1f}, {0.5f, 0.2f}, {0.2f, 0.6f}});
  builder.object(true).quad({0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0.7f, 0.7f}, {0.8f, 0.9f});
  scene::Scene scene = builder.build();
  const Atlas atlas = build(scene, 64);
  for (uint32_t texel = 0; texel < 64 * 64; ++texel) {
    long nearest = 1l << 30;
    for (const Slot& slot : atlas.slots) nearest = std::min(nearest, distance2(atlas, texel, slot.texel));
    if (nearest > kGutterTexels * kGutterTexels) {
      EXPECT_EQ(atlas.source[texel], kNone);
      continue;
    }
    ASSERT_NE(atlas.source[texel], kNone) << "black gutter at " << texel;
    ASSERT_NE(atlas.texel_slot[atlas.source[texel]], kNone);
    // Dead reckoning may miss the very nearest by a fraction of a texel.
    EXPECT_LE(std::sqrt(double(distance2(atlas, texel, atlas.source[texel]))), std::sqrt(double(nearest)) + 0.5);
  }
}

TEST(Gutters, BilinearLookupNeverMeetsAnUnfilledTexel) {
  scene::Scene scene = SceneBuilder().object(false).box({0, 0, 0}, {3, 2, 1}).build();
  const Atlas atlas = build(scene, 48);
  for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
    for (int i = 0; i <= 20; ++i)
      for (int j = 0; i + j <= 20; ++j) {
        const float u = float(i) / 20, v = float(j) / 20;
        const auto& [a, b, c] = scene.mesh.triangles[t];
        const Vec2 p = (atlas.uv[a] * (1 - u - v) + atlas.uv[b] * u + atlas.uv[c] * v) * 48.0f - Vec2(0.5f);
        for (int dy = 0; dy < 2; ++dy)
          for (int dx = 0; dx < 2; ++dx) {
            const int x = std::clamp(int(std::floor(p.x)) + dx, 0, 47), y = std::clamp(int(std::floor(p.y)) + dy, 0, 47);
            EXPECT_NE(atlas.source[size_t(y) * 48 + x], kNone);
          }
      }
}

TEST(Sources, InvalidTexelsShowTheNearestValidOneOfTheirOwnChart) {
  // Charts 0 0 0 1 1 1 0 0 2: two charts touch, and the last two texels of chart 0 lie apart from the rest of it.
  Atlas atlas;
  atlas.width = 9, atlas.height = 1;
  const uint32_t charts[9] = {0, 0, 0, 1, 1, 1, 0, 0, 2};
  for (uint32_t x = 0; x < 9; ++x) {
    Slot slot;
    slot.texel = x, slot.chart = charts[x];
    atlas.slots.push_back(slot);
    atlas.texel_slot.push_back(x);
  }
  EXPECT_EQ(fillSources(atlas, {1, 0, 0, 1, 0, 1, 0, 0, 0}), 1u);
  EXPECT_EQ(atlas.source, (std::vector<uint32_t>{0, 0, 0, 3, 3, 5, 0, 0, 8}));
}

TEST(Validity, TexelsInsideABoxShowTheFloorAroundIt) {
  scene::Scene scene = boxThroughFloor(false);
  Atlas atlas = build(scene, 64);
  const trace::Tracer tracer(scene, 1);
  const ValidityReport report = fillInvalid(atlas, scene, tracer, 1, 1, nullptr);
  EXPECT_GT(report.buried, 0u);
  size_t buried_floor = 0, floor = 0;
  const uint32_t floor_chart = atlas.slots[atlas.texel_slot[0]].chart;
  for (const Slot& slot : atlas.slots) {
    if (slot.chart != floor_chart) continue;
    ++floor;
    const bool inside = slot.position.x > 4 && slot.position.x < 10 && slot.position.z > 4 && slot.position.z < 10;
    buried_floor += inside;
    const uint32_t source = atlas.source[slot.texel];
    EXPECT_EQ(source != slot.texel, inside) << slot.position.x << " " << slot.position.z;
    const Slot& shown = atlas.slots[atlas.texel_slot[source]];
    EXPECT_EQ(shown.chart, floor_chart);
    if (inside) {
      EXPECT_FALSE(shown.position.x > 4 && shown.position.x < 10 && shown.position.z > 4 && shown.position.z < 10);
    }
  }
  EXPECT_EQ(floor, 32u * 32u);
  EXPECT_EQ(buried_floor, 12u * 12u);
}

TEST(Validity, TheInsideOfADoubleSidedBoxIsARoom) {
  scene::Scene scene = boxThroughFloor(true);
  Atlas atlas = build(scene, 64);
  const trace::Tracer tracer(scene, 1);
  fillInvalid(atlas, scene, tracer, 1, 1, nullptr);
  const uint32_t floor_chart = atlas.slots[atlas.texel_slot[0]].chart;
  for (const Slot& slot : atlas.slots)
    if (slot.chart == floor_chart) {
      EXPECT_EQ(atlas.source[slot.texel], slot.texel);
    }
}

TEST(Validity, AChartBuriedWholeKeepsItsOwnTexels) {
  SceneBuilder builder;
  builder.object(true).quad({1, 1, 1}, {0, 0, 1}, {1, 0, 0}, {0, 0}, {0.25f, 0.25f});
  builder.object(false).box({0, 0, 0}, {3, 3, 3});
  scene::Scene scene = builder.build();
  Atlas atlas = build(scene, 64);
  const trace::Tracer tracer(scene, 1);
  const ValidityReport report = fillInvalid(atlas, scene, tracer, 1, 1, nullptr);
  EXPECT_EQ(report.buried, 256u);
  EXPECT_EQ(report.unfilled, 256u);
  EXPECT_EQ(atlas.source[0], 0u);
}

TEST(Validity, IsTheSameForAnyNumberOfThreads) {
  scene::Scene scene = boxThroughFloor(false);
  Atlas one = build(scene, 64), four = one;
  const trace::Tracer tracer(scene, 1);
  fillInvalid(one, scene, tracer, 9, 1, nullptr);
  fillInvalid(four, scene, tracer, 9, 4, nullptr);
  EXPECT_EQ(one.source, four.source);
}

TEST(Validity, StopsWhenCancelled) {
  scene::Scene scene = boxThroughFloor(false);
  Atlas atlas = build(scene, 64);
  const trace::Tracer tracer(scene, 1);
  CancelFlag cancel;
  cancel.cancel();
  EXPECT_THROW(fillInvalid(atlas, scene, tracer, 1, 1, &cancel), Cancelled);
}

}  // namespace
}  // namespace lightwell::atlas
