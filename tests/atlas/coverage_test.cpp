// Which surface lies under which texel: cutting, areas, means.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "precompute/atlas/atlas.h"
#include "precompute/atlas/coverage.h"
#include "precompute/core/random.h"
#include "tests/atlas/scene_builder.h"

namespace lightwell::atlas {
namespace {

using test::SceneBuilder;
using test::surfaceArea;

Atlas build(scene::Scene& scene, int size) {
  Diagnostics diagnostics;
  AtlasOptions options;
  options.size = size;
  return buildAtlas(scene, options, diagnostics, 1);
}

/// Coverage of the given coordinates as they are, sound or not.
Atlas coverAsGiven(const scene::Scene& scene, int size) {
  Atlas atlas;
  atlas.width = atlas.height = size;
  atlas.uv = scene.mesh.lightmap_uv;
  buildCoverage(scene.mesh, atlas);
  return atlas;
}

double slotArea(const Atlas& atlas) {
  double area = 0;
  for (const Slot& slot : atlas.slots) area += slot.area;
  return area;
}

bool holds(const Atlas& atlas, uint32_t slot, uint32_t triangle) {
  for (uint32_t i = 0; i < atlas.slots[slot].patch_count; ++i)
    if (atlas.patches[atlas.slots[slot].first_patch + i].triangle == triangle) return true;
  return false;
}

TEST(ClipToCells, PiecesPartitionEveryKindOfTriangle) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(0, 32);
  for (int i = 0; i < 3000; ++i) {
    ClipVertex c[3] = {{place(random), place(random), 0, 0}, {place(random), place(random), 1, 0}, {place(random), place(random), 0, 1}};
    switch (i % 6) {
      case 1: c[2].x = c[0].x + 1e-9, c[2].y = c[0].y; break;                                                // needle
      case 2: c[2].x = 0.5 * (c[0].x + c[1].x), c[2].y = 0.5 * (c[0].y + c[1].y); break;                     // a segment
      case 3: c[1].x = c[2].x = c[0].x, c[1].y = c[2].y = c[0].y; break;                                     // a point
      case 4: for (auto& v : c) v.x = std::round(v.x), v.y = std::round(v.y); break;                         // on the grid
      case 5: for (auto& v : c) v.x = 8; break;                                                              // along a grid line
    }
    double share = 0, area = 0;
    std::set<std::pair<long, long>> cells;
    clipToCells(c, {0, 32, 0, 32}, [&](long x, long y, const ClipPolygon& piece) {
      share += piece.share();
      area += piece.gridArea();
      EXPECT_TRUE(cells.insert({x, y}).second) << "cell emitted twice";
      for (int k = 0; k < piece.count; ++k) {
        EXPECT_GE(piece.vertex[k].x, double(x));
        EXPECT_LE(piece.vertex[k].x, double(x + 1));
        EXPECT_GE(piece.vertex[k].y, double(y));
        EXPECT_LE(piece.vertex[k].y, double(y + 1));
      }
    });
    ASSERT_NEAR(share, 1, 1e-9) << i;
    const double whole = 0.5 * std::abs((c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y));
    ASSERT_NEAR(area, whole, 1e-9) << i;
  }
}

TEST(Coverage, RandomSoupKeepsItsAreaAndCoversEveryPoint) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> unit(0, 1);
  SceneBuilder builder;
  builder.object(true);
  for (int i = 0; i < 400; ++i) {
    const float size = std::pow(10.0f, -6 * unit(random));  // from the whole atlas to a millionth of it
    Vec2 uv[3];
    Vec3 p[3];
    const Vec2 base(unit(random), unit(random));
    for (int k = 0; k < 3; ++k) {
      const auto near = [&](float coordinate) { return std::clamp(coordinate + size * (unit(random) - 0.5f), 0.0f, 1.0f); };
      uv[k] = Vec2(near(base.x), near(base.y));
      p[k] = Vec3(unit(random), unit(random), unit(random)) * size;
    }
    builder.triangle(p, uv);
  }
  const scene::Scene scene = builder.build();
  for (int size : {1, 7, 64, 200}) {
    const Atlas atlas = coverAsGiven(scene, size);
    EXPECT_NEAR(slotArea(atlas) / surfaceArea(scene.mesh), 1, 1e-4) << size;
    const Sampler sampler(1, 1);
    for (uint32_t t = 0; t < scene.mesh.triangles.size(); ++t)
      for (uint32_t s = 0; s < 64; ++s) {
        const Vec2 b = s < 3 ? Vec2(s == 1, s == 2) : sampleTriangle(sampler.get2D(s, t));
        const uint32_t slot = atlas.slotAt(scene.mesh, t, b.x, b.y);
        ASSERT_LT(slot, atlas.slots.size());
        ASSERT_TRUE(holds(atlas, slot, t)) << "triangle " << t << " at size " << size;
      }
  }
}

TEST(Coverage, FindsExactlyTheTexelsUnderASliver) {
  // A needle of a thousandth of a texel's width on a slanted line: few texel centres lie in it.
  const int size = 64;
  const Vec2 from(0.03f, 0.11f), to(0.95f, 0.62f), across(-0.5e-5f, 1e-5f);
  SceneBuilder builder;
  builder.object(true).triangle({{0, 0, 0}, {1, 0, 0}, {0, 1e-4f, 0}}, {from, to, from + across});
  const Atlas atlas = coverAsGiven(builder.build(), size);
  std::set<uint32_t> expected;
  for (int i = 0; i <= 200000; ++i) {
    const Vec2 p = (from + (to - from) * (float(i) / 200000)) * float(size);
    expected.insert(uint32_t(p.y) * uint32_t(size) + uint32_t(p.x));
  }
  std::set<uint32_t> covered;
  for (const Slot& slot : atlas.slots) covered.insert(slot.texel);
  for (uint32_t texel : expected) EXPECT_TRUE(covered.count(texel)) << texel;
  EXPECT_LE(covered.size(), expected.size() + 2);
}

TEST(Coverage, MicroTrianglesBesideAGiantAllCount) {
  SceneBuilder builder;
  builder.object(true).quad({0, 0, 0}, {8, 0, 0}, {0, 8, 0}, {0, 0}, {1, 1});
  for (int i = 0; i < 1000; ++i) {
    const float x = 0.501f + 1e-6f * float(i);
    builder.triangle({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{x, 0.501f}, {x + 1e-6f, 0.501f}, {x, 0.501f + 1e-6f}});
  }
  const scene::Scene scene = builder.build();
  const Atlas atlas = coverAsGiven(scene, 16);
  EXPECT_EQ(atlas.slots.size(), 256u);
  const Slot& crowded = atlas.slots[atlas.texel_slot[8 * 16 + 8]];
  EXPECT_NEAR(crowded.area, 64.0 / 256 + 500, 0.05);
  EXPECT_NEAR(slotArea(atlas) / surfaceArea(scene.mesh), 1, 1e-4);
}

TEST(Coverage, TrianglesWithoutExtentInUvSpaceKeepTheirArea) {
  SceneBuilder builder;
  builder.object(true);
  const Vec3 p[3] = {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}};
  builder.triangle(p, {{0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 0.5f}});   // a point on a texel corner
  builder.triangle(p, {{1, 1}, {1, 1}, {1, 1}});                    // the far corner of the atlas
  builder.triangle(p, {{0.1f, 0.25f}, {0.9f, 0.25f}, {0.5f, 0.25f}});  // a segment along a texel border
  const scene::Scene scene = builder.build();
  const Atlas atlas = coverAsGiven(scene, 8);
  EXPECT_NEAR(slotArea(atlas), 6, 1e-4);
  EXPECT_NE(atlas.texel_slot[63], kNone);
  for (uint32_t t = 0; t < 3; ++t) EXPECT_LT(atlas.slotAt(scene.mesh, t, 0.3f, 0.3f), atlas.slots.size());
}

TEST(Coverage, RoundingOfCoordinatesCoversNoFurtherTexels) {
  // A quad on every other tenth: 0.1f … are not representable, yet a 10 × 10 atlas has exactly one texel a quad.
  SceneBuilder builder;
  builder.object(true);
  for (int i = 0; i < 5; ++i) {
    const float low = float(2 * i) / 10, high = float(2 * i + 1) / 10;
    builder.quad({low, 0, 0}, {1, 0, 0}, {0, 1, 0}, {low, low}, {high, high});
  }
  EXPECT_EQ(coverAsGiven(builder.build(), 10).slots.size(), 5u);
}

TEST(Coverage, PointsOnABorderBetweenChartsStayOnTheirOwn) {
  SceneBuilder builder;
  builder.object(true).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0}, {0.5f, 1}).quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5f, 0}, {1, 1});
  const scene::Scene scene = builder.build();
  const Atlas atlas = coverAsGiven(scene, 16);
  for (uint32_t t = 0; t < 4; ++t)
    for (int i = 0; i <= 10; ++i) {
      const float along = float(i) / 10;
      for (const Vec2& b : {Vec2(along, 0), Vec2(0, along), Vec2(along, 1 - along)})
        EXPECT_TRUE(holds(atlas, atlas.slotAt(scene.mesh, t, b.x, b.y), t)) << t << " " << b.x << " " << b.y;
    }
}

TEST(Coverage, OneTexelHoldsEverything) {
  SceneBuilder builder;
  builder.object(true).quad({0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {0.1f, 0.2f}, {0.7f, 0.9f});
  scene::Scene scene = builder.build();
  const Atlas atlas = build(scene, 1);
  ASSERT_EQ(atlas.slots.size(), 1u);
  EXPECT_FALSE(atlas.unwrapped);
  EXPECT_NEAR(atlas.slots[0].area, 6, 1e-5);
  EXPECT_NEAR((atlas.slots[0].position - Vec3(1, 1.5f, 0)).length(), 0, 1e-5);
  EXPECT_EQ(atlas.source[0], 0u);
}

TEST(Coverage, NoTrianglesNoSlots) {
  scene::Scene scene;
  const Atlas atlas = build(scene, 4);
  EXPECT_TRUE(atlas.slots.empty());
  EXPECT_EQ(atlas.source, std::vector<uint32_t>(16, kNone));
}

TEST(SampleSlot, IsUniformOverTheSurfaceOfTheTexel) {
  SceneBuilder builder;  // two sheets of areas 1 and 3 share one texel
  builder.object(true).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0}, {0.5f, 1}).quad({5, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0.5f, 0}, {1, 1});
  scene::Scene scene = builder.build();
  Atlas atlas = build(scene, 1);
  for (const bool cumulative : {true, false}) {
    if (!cumulative) atlas.patch_cumulative_area.clear();
    const Sampler sampler(1, 0);
    Vec3 mean(0, 0, 0);
    const int samples = 4096;
    for (int s = 0; s < samples; ++s) {
      const SurfacePoint point = sampleSlot(scene.mesh, atlas, atlas.slots[0], sampler.get1D(s, 0), sampler.get2D(s, 1));
      EXPECT_TRUE(point.position.x <= 1 || (point.position.x >= 5 && point.position.x <= 8));
      EXPECT_NEAR((point.normal - Vec3(0, 0, 1)).length(), 0, 1e-6);
      mean += point.position / float(samples);
    }
    EXPECT_NEAR(mean.x, 0.25 * 0.5 + 0.75 * 6.5, 0.01);
    EXPECT_NEAR(mean.y, 0.5, 0.01);
  }
}

TEST(Slots, TextureDetailFinerThanATexelIsAveraged) {
  SceneBuilder builder;
  builder.object(true).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0}, {1, 1});
  scene::Scene scene = builder.build();
  scene::Texture checker;  // black and white in linear light, one texture texel a field; alternate ones cut out is tested below
  checker.width = checker.height = 64;
  for (int i = 0; i < 64 * 64; ++i) {
    const uint8_t value = (i % 64 + i / 64) % 2 ? 255 : 0;
    checker.rgba.insert(checker.rgba.end(), {value, value, value, 255});
  }
  scene.textures.push_back(checker);
  scene.materials[0].base_color_texture = 0;
  scene.mesh.base_uv = scene.mesh.lightmap_uv;
  const Atlas atlas = build(scene, 4);
  ASSERT_EQ(atlas.slots.size(), 16u);
  double mean = 0;
  for (const Slot& slot : atlas.slots) {
    EXPECT_NEAR(slot.albedo_rgb.x, 0.5, 0.2);
    mean += slot.albedo_rgb.x / 16;
  }
  EXPECT_NEAR(mean, 0.5, 0.03);
}

TEST(Slots, CutOutPartsLendNoColour) {
  SceneBuilder builder;
  builder.object(true).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0}, {1, 1});
  scene::Scene scene = builder.build();
  scene::Texture leaf;  // left half green and solid, right half red and cut out
  leaf.width = leaf.height = 32;
  for (int i = 0; i < 32 * 32; ++i) {
    if (i % 32 < 16) leaf.rgba.insert(leaf.rgba.end(), {0, 255, 0, 255});
    else leaf.rgba.insert(leaf.rgba.end(), {255, 0, 0, 0});
  }
  leaf.wrap_u = leaf.wrap_v = scene::Texture::Wrap::clamp;
  scene.textures.push_back(leaf);
  scene.materials[0].base_color_texture = 0;
  scene.materials[0].alpha_mode = scene::AlphaMode::mask;
  scene.mesh.base_uv = scene.mesh.lightmap_uv;
  const Atlas atlas = build(scene, 1);
  EXPECT_GT(atlas.slots[0].albedo_rgb.y, 0.95f);
  EXPECT_LT(atlas.slots[0].albedo_rgb.x, 0.05f);
}

TEST(Slots, NormalIsTheMeanByArea) {
  SceneBuilder builder;  // areas 3 and 4 at a right angle
  builder.object(true).quad({0, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, 0}, {0.5f, 1}).quad({0, 0, 0}, {0, 4, 0}, {0, 0, 1}, {0.5f, 0}, {1, 1});
  scene::Scene scene = builder.build();
  scene.materials[0].double_sided = true;
  const Atlas atlas = build(scene, 1);
  EXPECT_NEAR((atlas.slots[0].normal - Vec3(0.8f, 0, 0.6f)).length(), 0, 1e-5);
  EXPECT_TRUE(atlas.slots[0].double_sided);
}

}  // namespace
}  // namespace lightwell::atlas
