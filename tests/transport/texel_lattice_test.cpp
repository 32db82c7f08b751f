// Values over a lattice of texels: exact where they are not smooth or something stands near, few and good elsewhere.
#include "precompute/transport/texel_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

test::PreparedScene floorWith(bool wall) {
  test::SceneBuilder builder;
  const uint32_t grey = builder.material(test::diffuse(0.5f));
  builder.quad({-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, grey);
  if (wall) builder.quad({0.003f, 0.001f, -1}, {0, 0, 2}, {0, 0.5f, 0}, grey);  // stands across it, in the middle
  return test::PreparedScene(builder.take(), 128);
}

struct Filled {
  std::vector<Rgb> values_rgb;
  std::vector<char> evaluated;
  size_t count = 0;
};
Filled fill(const test::PreparedScene& p, const std::function<float(const Vec3&)>& light, const LatticeOptions& options = {}, int threads = 2) {
  Filled filled;
  filled.evaluated.resize(p.atlas.slots.size());
  filled.values_rgb = valuesOverLattice(
      p.atlas, *p.tracer, options, threads, nullptr,
      [&](std::span<const uint32_t> slots, std::span<Rgb> values_rgb) {
        for (size_t i = 0; i < slots.size(); ++i) values_rgb[i] = Rgb(light(p.atlas.slots[slots[i]].position)), filled.evaluated[slots[i]] = 1;
      },
      &filled.count);
  return filled;
}

float smooth(const Vec3& p) { return 1 / (1 + 0.5f * p.length2()); }

TEST(TexelLattice, FewValuesAreEnoughWhereLightIsSmooth) {
  const test::PreparedScene p = floorWith(false);
  const Filled filled = fill(p, smooth);
  EXPECT_LT(filled.count, p.atlas.slots.size() / 5);
  EXPECT_EQ(filled.count, size_t(std::count(filled.evaluated.begin(), filled.evaluated.end(), 1)));
  double most = 0;
  for (size_t i = 0; i < p.atlas.slots.size(); ++i) most = std::max(most, std::abs(double(filled.values_rgb[i].x / smooth(p.atlas.slots[i].position)) - 1));
  EXPECT_LT(most, 0.01);
  EXPECT_GT(most, 0) << "something was interpolated";
}

TEST(TexelLattice, AnEdgeOfAShadowStaysWhereItIs) {
  const test::PreparedScene p = floorWith(false);
  const auto light = [](const Vec3& at) { return at.x + 0.37f * at.z > 0.113f ? 1.0f : 0.2f; };
  const Filled filled = fill(p, light);
  for (size_t i = 0; i < p.atlas.slots.size(); ++i) ASSERT_NEAR(filled.values_rgb[i].x, light(p.atlas.slots[i].position), 1e-6f) << i;
  EXPECT_LT(filled.count, p.atlas.slots.size() / 2);
}

TEST(TexelLattice, NothingIsInterpolatedCloseToWhatStandsThere) {
  const test::PreparedScene with_wall = floorWith(true);
  const Filled filled = fill(with_wall, smooth);
  size_t near = 0, near_evaluated = 0;
  for (size_t i = 0; i < with_wall.atlas.slots.size(); ++i) {
    const atlas::Slot& slot = with_wall.atlas.slots[i];
    if (!(slot.normal.y > 0.9f) || std::abs(slot.position.x) > 0.03f) continue;
    ++near, near_evaluated += size_t(filled.evaluated[i]);
  }
  EXPECT_GT(near, 50u);
  EXPECT_EQ(near_evaluated, near);
}

TEST(TexelLattice, EachForItselfAndTheSameForAnyNumberOfThreads) {
  const test::PreparedScene p = floorWith(true);
  EXPECT_EQ(fill(p, smooth, {.coarsest = 1}).count, p.atlas.slots.size());
  const Filled one = fill(p, smooth, {}, 1), five = fill(p, smooth, {}, 5);
  EXPECT_EQ(one.values_rgb, five.values_rgb);
  EXPECT_EQ(one.evaluated, five.evaluated);
}

}  // namespace
}  // namespace lightwell::transport
