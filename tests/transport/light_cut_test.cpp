// Cuts through a tree of lights: bounds that hold, nothing lost, sizes that hardly grow with the number of lights.
#include "precompute/transport/many_lights/light_cut.h"

#include <gtest/gtest.h>

#include <set>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

/// Points that shine by the cosine, on the floor, the ceiling and the walls of a unit room.
std::vector<LightBounds> lightsInARoom(uint32_t count) {
  std::vector<LightBounds> lights(count);
  const Sampler sampler(1, count);
  for (uint32_t i = 0; i < count; ++i) {
    const Vec2 place = sampler.get2D(i, 0);
    const int side = int(sampler.get1D(i, 1) * 6), axis = side / 2;
    Vec3 at(0.0f), normal(0.0f);
    at[axis] = float(side % 2), at[(axis + 1) % 3] = place.x, at[(axis + 2) % 3] = place.y;
    normal[axis] = side % 2 ? -1.0f : 1.0f;
    lights[i] = {.box = Box3(at), .axis = normal, .normal_spread = 0, .emission_spread = kPi / 2, .power = (0.5f + sampler.get1D(i, 2)) / float(count)};
  }
  return lights;
}

double given(const LightBounds& light, const Vec3& position, const Vec3& normal) {
  const Vec3 offset = light.box.center() - position;
  const double distance = double(offset.length());
  if (!(distance > 0)) return 0;
  const double received = std::max(0.0, double(offset.dot(normal)) / distance), sent = std::max(0.0, -double(offset.dot(light.axis)) / distance);
  return double(light.power) * received * sent / (distance * distance);
}

std::vector<uint32_t> itemsOf(const LightTree& tree, uint32_t node) {
  const uint32_t child = tree.firstChild(node);
  if (child == kNone) return {tree.pickIn(node, Vec3(0.0f), Vec3(0, 1, 0), 0).item};
  std::vector<uint32_t> items = itemsOf(tree, child);
  const auto more = itemsOf(tree, child + 1);
  items.insert(items.end(), more.begin(), more.end());
  return items;
}

/// Receivers near each other somewhere in the room, and the points that they stand for.
struct Place {
  Receivers receivers;
  std::vector<std::pair<Vec3, Vec3>> points;  // with normals
};
Place placeInARoom(uint32_t number) {
  const Sampler sampler(2, number);
  Place place;
  const auto direction = [&](uint32_t d) {
    const Vec2 u = sampler.get2D(0, d);
    const float z = 1 - 2 * u.x, r = std::sqrt(std::max(0.0f, 1 - z * z));
    return Vec3(r * std::cos(2 * kPi * u.y), r * std::sin(2 * kPi * u.y), z);
  };
  for (int k = 0; k < 3; ++k) place.receivers.center[k] = sampler.get1D(0, uint32_t(k));
  place.receivers.normal = direction(5);
  place.receivers.radius = number % 3 == 0 ? 0 : 0.02f * sampler.get1D(0, 6);
  place.receivers.cos_spread = number % 2 == 0 ? 1 : std::cos(0.3f);
  for (uint32_t i = 0; i < 4; ++i) {
    const Vec3 tilted = (place.receivers.normal + direction(10 + i) * (number % 2 == 0 ? 0.0f : 0.28f)).normalized();
    place.points.emplace_back(place.receivers.center + direction(20 + i) * place.receivers.radius, tilted);
  }
  return place;
}

TEST(LightCut, BoundsAreNeverExceeded) {
  const auto lights = lightsInARoom(300);
  const LightTree tree(lights);
  for (uint32_t number = 0; number < 60; ++number) {
    const Place place = placeInARoom(number);
    for (uint32_t node = 0; node < tree.nodeCount(); ++node) {
      const double bound = double(tree.bound(node, place.receivers));
      for (const auto& [position, normal] : place.points) {
        double sum = 0;
        for (const uint32_t i : itemsOf(tree, node)) sum += given(lights[i], position, normal);
        ASSERT_LE(sum, bound * 1.0001 + 1e-9) << "node " << node << ", place " << number;
      }
    }
  }
}

TEST(LightCut, HoldsEveryLightThatReachesOnceAndNoNodeThatMayGiveMore) {
  const auto lights = lightsInARoom(2000);
  const LightTree tree(lights);
  LightCut cut(tree);
  for (uint32_t number = 0; number < 40; ++number) {
    const Place place = placeInARoom(number);
    const double most = 0.01;
    cut.begin(place.receivers);
    cut.refine(most, 1u << 20);
    std::multiset<uint32_t> held;
    for (const uint32_t node : cut.nodes()) {
      const auto items = itemsOf(tree, node);
      held.insert(items.begin(), items.end());
      ASSERT_TRUE(items.size() == 1 || double(tree.bound(node, place.receivers)) <= most);
    }
    for (uint32_t i = 0; i < lights.size(); ++i) {
      ASSERT_LE(held.count(i), 1u);
      for (const auto& [position, normal] : place.points)
        ASSERT_TRUE(held.count(i) == 1 || !(given(lights[i], position, normal) > 0)) << i;
    }
  }
}

TEST(LightCut, ALightOfEachNodeGivesWhatAllDoOnAverage) {
  const auto lights = lightsInARoom(5000);
  const LightTree tree(lights);
  LightCut cut(tree);
  double got = 0, expected = 0;
  for (uint32_t number = 0; number < 200; ++number) {
    Place place = placeInARoom(number);
    const auto& [position, normal] = place.points[0];
    double all = 0;
    for (const LightBounds& light : lights) all += given(light, position, normal);
    cut.begin(place.receivers);
    cut.refine(0.02 * all, 1u << 20);
    const Sampler sampler(3, number);
    double sum = 0;
    for (const uint32_t node : cut.nodes()) {
      const auto pick = tree.pickIn(node, position, normal, sampler.get1D(0, node));
      if (pick.item != kNone) sum += given(lights[pick.item], position, normal) / double(pick.probability);
    }
    EXPECT_NEAR(sum / all, 1, 0.08) << number;
    got += sum, expected += all;
  }
  EXPECT_NEAR(got / expected, 1, 0.004);
}

TEST(LightCut, GrowsFarSlowerThanTheNumberOfLights) {
  double nodes[2] = {0, 0};
  for (int k = 0; k < 2; ++k) {
    const auto lights = lightsInARoom(k == 0 ? 2000 : 128000);
    const LightTree tree(lights);
    LightCut cut(tree);
    for (uint32_t number = 0; number < 50; ++number) {
      const Place place = placeInARoom(number);
      cut.begin(place.receivers);
      cut.refine(0.02, 1u << 20);
      nodes[k] += double(cut.nodes().size()) / 50;
    }
  }
  EXPECT_LT(nodes[1], 2.5 * nodes[0]) << "64 times the lights";
  EXPECT_GT(nodes[0], 10);
}

TEST(LightCut, IsEmptyWithoutLights) {
  const LightTree tree(std::vector<LightBounds>(3));
  LightCut cut(tree);
  cut.begin({});
  cut.refine(0, 10);
  EXPECT_TRUE(cut.nodes().empty());
}

}  // namespace
}  // namespace lightwell::transport
