// Interpolation between patches: along the surface, across the borders of charts, never through things.
#include <gtest/gtest.h>

#include "precompute/transport/radiosity/texel_weights.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

struct Interpolated {
  test::PreparedScene p;
  Sides sides;
  Patches patches;
  TexelWeights weights;
  Interpolated(scene::Scene scene, uint32_t coarsest, int size = 64, int threads = 2) : p(std::move(scene), size), sides(surfaceSides(p.atlas)) {
    const std::vector<float> exposed(sides.slot.size(), 1.0f);
    PatchOptions options;
    options.coarsest = options.finest = coarsest;
    patches = makePatches(p.scene, p.atlas, *p.tracer, sides, exposed, options);
    weights = makeTexelWeights(p.atlas, *p.tracer, sides, patches, makePatchTree(patches), threads, nullptr);
  }
};

/// A floor of 8 m × 4 m from two quads that meet at x = 4, each a chart of its own.
test::SceneBuilder twoQuads() {
  test::SceneBuilder builder;
  const uint32_t white = builder.material(test::diffuse(0.5f));
  builder.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, white).quad({4, 0, 0}, {0, 0, 4}, {4, 0, 0}, white);
  return builder;
}

TEST(TexelWeights, ALinearFieldIsReproducedAcrossTheBorderOfCharts) {
  const Interpolated f(twoQuads().take(), 4);
  uint32_t at_border = 0;
  for (size_t i = 0; i < f.weights.slot.size(); ++i) {
    const Vec3 at = f.p.atlas.slots[f.weights.slot[i]].position;
    Vec3 mixed(0.0f);
    float sum = 0;
    EXPECT_EQ(f.weights.patch[i][0], f.patches.patch_of_side[f.weights.slot[i]]);
    for (size_t k = 0; k < 4; ++k) {
      EXPECT_GE(f.weights.weight[i][k], 0.0f);
      sum += f.weights.weight[i][k];
      if (f.weights.patch[i][k] != kNone) mixed += f.patches.position[f.weights.patch[i][k]] * f.weights.weight[i][k];
    }
    EXPECT_NEAR(sum, 1.0f, 1e-5f);
    // Away from the floor's edges, where patches lie around the texel.
    if (at.x < 0.8f || at.x > 7.2f || at.z < 0.8f || at.z > 3.2f) continue;
    at_border += std::abs(at.x - 4.0f) < 0.3f;
    EXPECT_LT((mixed - at).length(), 0.05f) << at.x << " " << at.z;
  }
  EXPECT_GT(at_border, 10u);
}

TEST(TexelWeights, NothingIsMixedThroughAWall) {
  auto builder = twoQuads();
  const uint32_t white = builder.material(test::diffuse(0.5f));
  // 5 mm thick, on the seam.
  builder.quad({3.9975f, 0, 0}, {0, 0, 4}, {0, 3, 0}, white).quad({4.0025f, 0, 0}, {0, 3, 0}, {0, 0, 4}, white);
  const Interpolated f(builder.take(), 4);
  for (size_t i = 0; i < f.weights.slot.size(); ++i) {
    const atlas::Slot& slot = f.p.atlas.slots[f.weights.slot[i]];
    if (slot.normal.y < 0.5f) continue;
    for (size_t k = 0; k < 4; ++k) {
      if (f.weights.weight[i][k] > 0) {
        EXPECT_EQ(f.patches.position[f.weights.patch[i][k]].x < 4, slot.position.x < 4);
      }
    }
  }
}

TEST(TexelWeights, StepsAndEdgesDoNotMix) {
  test::SceneBuilder builder;
  const uint32_t white = builder.material(test::diffuse(0.5f));
  // Two treads, 0.25 m apart in height, and the riser between them.
  builder.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, white).quad({4, 0, 0}, {0, 0, 4}, {0, 0.25f, 0}, white).quad({4, 0.25f, 0}, {0, 0, 4}, {4, 0, 0}, white);
  const Interpolated f(builder.take(), 2);
  for (size_t i = 0; i < f.weights.slot.size(); ++i) {
    const atlas::Slot& slot = f.p.atlas.slots[f.weights.slot[i]];
    for (size_t k = 0; k < 4; ++k) {
      if (f.weights.weight[i][k] <= 0) continue;
      EXPECT_GT(f.patches.normal[f.weights.patch[i][k]].dot(slot.normal), 0.9f);
      if (slot.normal.y > 0.5f) {
        EXPECT_NEAR(f.patches.position[f.weights.patch[i][k]].y, slot.position.y, 0.01f);
      }
    }
  }
}

TEST(TexelWeights, DoNotDependOnThreads) {
  const Interpolated one(twoQuads().take(), 4, 64, 1), three(twoQuads().take(), 4, 64, 3);
  EXPECT_EQ(one.weights.patch, three.weights.patch);
  EXPECT_EQ(one.weights.weight, three.weights.weight);
}

}  // namespace
}  // namespace lightwell::transport
