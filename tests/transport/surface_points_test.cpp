// Points for shadow maps: on the surfaces, even in every block, the same each time.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "precompute/transport/many_lights/surface_points.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

TEST(SurfacePoints, HaveTheAreaAndSpreadOverItEvenlyInEveryBlock) {
  const test::PreparedScene p(test::closedBox({1, 1.5f, 2}, test::diffuse(0.5f)));
  const SurfacePoints spread = spreadPoints(p.scene, p.atlas, 4096, 1);
  ASSERT_EQ(spread.points.size(), 4096u);
  std::array<double, 6> area{};
  double all = 0;
  for (uint32_t t = 0; t < p.scene.mesh.triangles.size(); ++t) {
    const auto& v = p.scene.mesh.triangles[t];
    const Vec3d a(p.scene.mesh.positions[v[0]]), b(p.scene.mesh.positions[v[1]]), c(p.scene.mesh.positions[v[2]]);
    area[t / 2] += 0.5 * (b - a).cross(c - a).length();
  }
  for (const double a : area) all += a;
  EXPECT_NEAR(spread.area / all, 1, 1e-6);
  const auto wallOf = [&](const SurfacePoint& point) {
    for (uint32_t t = 0; t < p.scene.mesh.triangles.size(); ++t) {
      const auto& v = p.scene.mesh.triangles[t];
      const Vec3 a = p.scene.mesh.positions[v[0]], n = (p.scene.mesh.positions[v[1]] - a).cross(p.scene.mesh.positions[v[2]] - a).normalized();
      if (n.dot(point.normal) > 0.999f && std::abs(n.dot(point.position - a)) < 1e-4f) return t / 2;
    }
    return kNone;
  };
  for (const uint32_t size : {256u, 1024u, 4096u})
    for (uint32_t first = 0; first < 4096; first += size) {
      std::array<double, 6> count{};
      for (uint32_t i = first; i < first + size; ++i) {
        const uint32_t wall = wallOf(spread.points[i]);
        ASSERT_NE(wall, kNone) << "a point lies on no wall";
        ++count[wall];
      }
      for (size_t w = 0; w < 6; ++w) ASSERT_NEAR(count[w], size * area[w] / all, 2.5) << size << " from " << first;
    }
  // Blocks are sparser than random ones are close: no two points of 256 as near as random ones nearly always would be.
  double nearest = 1e30;
  for (uint32_t i = 0; i < 256; ++i)
    for (uint32_t k = 0; k < i; ++k) nearest = std::min(nearest, double((spread.points[i].position - spread.points[k].position).length()));
  EXPECT_GT(nearest, 0.05 * std::sqrt(all / 256));
}

TEST(SurfacePoints, KnowTheirTexelAndAreTheSameEachTime) {
  const test::PreparedScene p(test::closedBox({1, 1.5f, 2}, test::diffuse(0.5f)));
  const SurfacePoints a = spreadPoints(p.scene, p.atlas, 500, 3), b = spreadPoints(p.scene, p.atlas, 500, 3), more = spreadPoints(p.scene, p.atlas, 600, 3), other = spreadPoints(p.scene, p.atlas, 500, 4);
  size_t differ = 0;
  for (size_t i = 0; i < 500; ++i) {
    ASSERT_EQ(a.points[i].position, b.points[i].position);
    ASSERT_EQ(a.points[i].position, more.points[i].position) << "more points go on where fewer end";
    ASSERT_NE(a.points[i].texel, kNone);
    ASSERT_EQ(p.atlas.source[a.points[i].texel], a.points[i].texel);
    const atlas::Slot& slot = p.atlas.slots[p.atlas.texel_slot[a.points[i].texel]];
    ASSERT_LT((slot.position - a.points[i].position).length(), 4 * std::sqrt(slot.area) + 0.1f);
    differ += a.points[i].position != other.points[i].position;
  }
  EXPECT_GT(differ, 450u);
}

TEST(SurfacePoints, LeaveOutWhatIsNotThere) {
  test::SceneBuilder builder;
  scene::Material glass = test::diffuse(0.5f);
  glass.alpha_mode = scene::AlphaMode::blend;
  glass.alpha = 0.25f;
  const uint32_t solid = builder.material(test::diffuse(0.5f)), thin = builder.material(glass);
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, solid).quad({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, thin);
  const test::PreparedScene p(builder.take());
  const SurfacePoints spread = spreadPoints(p.scene, p.atlas, 2000, 1);
  double above = 0;
  for (const auto& point : spread.points) above += point.position.y > 0.5f;
  EXPECT_NEAR(above / 2000, 0.2, 0.02);
  EXPECT_NEAR(spread.area, 1.25, 0.03);
  scene::Scene empty;
  EXPECT_TRUE(spreadPoints(empty, atlas::Atlas{}, 100, 1).points.empty());
}

}  // namespace
}  // namespace lightwell::transport
