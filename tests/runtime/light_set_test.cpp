// Places of virtual lights in a lamp's projection: triangulation and largest empty circles against brute force, bounded updates, an even spread.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "runtime/src/dynamic/light_set.h"

namespace lightwell::runtime {
namespace {

Double3 randomDirection(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const Double3 v{normal(random), normal(random), normal(random)};
  return v * (1 / std::sqrt(dot(v, v)));
}
double distance(Double3 a, Double3 b) { return std::sqrt(dot(a - b, a - b)); }

TEST(SphereHull, EmptyCirclesAreEmptyAndFacesMakeASphere) {
  std::mt19937 random(1);
  for (const uint32_t count : {4u, 5u, 12u, 100u, 400u}) {
    std::vector<Double3> points;
    for (uint32_t i = 0; i < count; ++i) points.push_back(randomDirection(random));
    SphereHull hull;
    ASSERT_TRUE(hull.allocate({}, count + 20));
    ASSERT_TRUE(hull.build(points.data(), count));
    for (int i = 0; i < 20; ++i) {
      points.push_back(randomDirection(random));
      hull.insert(points.back());
    }
    EXPECT_EQ(hull.count(), 2 * points.size() - 4) << "Euler";
    for (uint32_t f = 0; f < hull.count(); ++f)
      for (const Double3& p : points) ASSERT_LE(dot(hull.face(f).normal, p), hull.face(f).offset + 1e-12) << count;
  }
}

TEST(SphereHull, TwinsAndPlanesAreNoTriangulation) {
  SphereHull hull;
  ASSERT_TRUE(hull.allocate({}, 16));
  const std::vector<Double3> same(8, Double3{0, 1, 0});
  EXPECT_FALSE(hull.build(same.data(), 8));
  std::vector<Double3> circle;
  for (int i = 0; i < 8; ++i) circle.push_back({std::cos(0.7 * i), std::sin(0.7 * i), 0});
  EXPECT_FALSE(hull.build(circle.data(), 8));
  EXPECT_EQ(hull.count(), 0u);
  circle[3] = {0, 0, 1};
  circle[4] = {0, 0, -1};
  ASSERT_TRUE(hull.build(circle.data(), 8));
  const uint32_t faces = hull.count();
  hull.insert(circle[3]);
  hull.insert({NAN, 0, 0});
  EXPECT_EQ(hull.count(), faces);
}

LampProjection projectionOf(LampProjection::Kind kind) {
  LampProjection p;
  p.kind = kind;
  if (kind == LampProjection::cone) p.axis[0] = 0.6f, p.axis[1] = 0, p.axis[2] = 0.8f, p.cos_outer = 0.6f;
  if (kind == LampProjection::plane) p.half[0] = 3, p.half[1] = 2;
  return p;
}
/// A random place of it, as the GPU gives it.
void randomAim(const LampProjection& p, std::mt19937& random, float* aim) {
  std::uniform_real_distribution<double> flat(-1, 1);
  Double3 v{flat(random), flat(random), 0};
  if (p.kind != LampProjection::plane) do v = randomDirection(random);
    while (p.kind == LampProjection::cone && v.x * double(p.axis[0]) + v.y * double(p.axis[1]) + v.z * double(p.axis[2]) < double(p.cos_outer));
  aim[0] = float(v.x), aim[1] = float(v.y), aim[2] = float(v.z), aim[3] = 1;
}
Double3 metric(const LampProjection& p, const float* aim) {
  const bool plane = p.kind == LampProjection::plane;
  return {double(aim[0]) * (plane ? double(p.half[0]) : 1), double(aim[1]) * (plane ? double(p.half[1]) : 1), double(aim[2])};
}

class LightSetTest : public testing::TestWithParam<LampProjection::Kind> {};

TEST_P(LightSetTest, ANewLightGoesWhereItIsEmptiest) {
  constexpr uint32_t kLights = 120;
  const LampProjection p = projectionOf(GetParam());
  std::mt19937 random(7);
  LightSet set;
  ASSERT_TRUE(set.allocate({}, kLights));
  for (int repeat = 0; repeat < 10; ++repeat) {
    std::vector<float> aims(kLights * 4);
    for (uint32_t i = 0; i < kLights; ++i) randomAim(p, random, &aims[i * 4]);
    aims[17 * 4 + 3] = 0;  // one has gone: no other moves
    std::vector<LightRequest> requests(kLights);
    uint32_t shining = 0;
    ASSERT_EQ(set.update(p, aims.data(), 1, requests.data(), shining), 1u);
    EXPECT_EQ(requests[0].light, 17);
    EXPECT_EQ(shining, kLights);
    const auto room = [&](const float* at) {
      double least = 1e30;
      for (uint32_t i = 0; i < kLights; ++i)
        if (i != 17) least = std::min(least, distance(metric(p, at), metric(p, &aims[i * 4])));
      return least;
    };
    double widest = 0;
    for (int i = 0; i < 20000; ++i) {
      float at[4];
      randomAim(p, random, at);
      widest = std::max(widest, room(at));
    }
    EXPECT_GT(room(requests[0].aim), 0.98 * widest) << repeat;
  }
}

TEST_P(LightSetTest, CrowdsDissolveWithinTheBudgetAndThenNothingMoves) {
  constexpr uint32_t kLights = 200, kBudget = 8;
  const LampProjection p = projectionOf(GetParam());
  std::mt19937 random(3);
  LightSet set;
  ASSERT_TRUE(set.allocate({}, kLights));
  std::vector<float> aims(kLights * 4);
  for (uint32_t i = 0; i < kLights; ++i) randomAim(p, random, &aims[i * 4]);
  std::vector<LightRequest> requests(kLights);
  const auto shortest = [&] {
    double least = 1e30;
    for (uint32_t i = 0; i < kLights; ++i)
      for (uint32_t k = 0; k < i; ++k) least = std::min(least, distance(metric(p, &aims[i * 4]), metric(p, &aims[k * 4])));
    return least;
  };
  const double before = shortest();
  uint32_t moved = 0, shining = 0, update = 0;
  do {
    moved = set.update(p, aims.data(), kBudget, requests.data(), shining);
    ASSERT_LE(moved, kBudget);
    for (uint32_t r = 0; r < moved; ++r) std::copy_n(requests[r].aim, 3, &aims[size_t(requests[r].light) * 4]);
  } while (moved > 0 && ++update < 200);
  EXPECT_LT(update, 200u) << "it comes to rest";
  EXPECT_GT(shortest(), 3 * before);
}

TEST_P(LightSetTest, WhateverTheGpuSaysPlacesAreInside) {
  constexpr uint32_t kLights = 32;
  const LampProjection p = projectionOf(GetParam());
  LightSet set;
  ASSERT_TRUE(set.allocate({}, kLights));
  std::vector<LightRequest> requests(kLights);
  uint32_t shining = 0;
  std::vector<std::vector<float>> answers{std::vector<float>(kLights * 4, 0.0f), std::vector<float>(kLights * 4, NAN), std::vector<float>(kLights * 4, 1.0f)};
  std::mt19937 random(5);
  for (const uint32_t valid : {1u, 2u, 3u, 4u}) {
    auto& few = answers.emplace_back(kLights * 4, 0.0f);
    for (uint32_t i = 0; i < valid; ++i) randomAim(p, random, &few[i * 4]);
  }
  for (const auto& aims : answers) {
    const uint32_t count = set.update(p, aims.data(), 5, requests.data(), shining);
    ASSERT_LE(count, 5u);
    for (uint32_t r = 0; r < count; ++r) {
      const float* a = requests[r].aim;
      const double length = std::sqrt(double(a[0]) * double(a[0]) + double(a[1]) * double(a[1]) + double(a[2]) * double(a[2]));
      if (p.kind == LampProjection::plane) {
        EXPECT_TRUE(std::abs(a[0]) <= 1.00001f && std::abs(a[1]) <= 1.00001f && a[2] == 0);
        continue;
      }
      EXPECT_NEAR(length, 1, 1e-5);
      const double cosine = double(a[0]) * double(p.axis[0]) + double(a[2]) * double(p.axis[2]);
      EXPECT_TRUE(p.kind != LampProjection::cone || cosine > double(p.cos_outer) - 1e-5) << cosine;
    }
  }
  EXPECT_EQ(set.restart(p, requests.data()), kLights);
}

INSTANTIATE_TEST_SUITE_P(Projections, LightSetTest, testing::Values(LampProjection::sphere, LampProjection::cone, LampProjection::plane),
                         [](const auto& info) { return info.param == LampProjection::sphere ? "Sphere" : info.param == LampProjection::cone ? "Cone" : "Plane"; });

}  // namespace
}  // namespace lightwell::runtime
