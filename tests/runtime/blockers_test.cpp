// Blockers: the share of a hemisphere that a sphere fills against quadrature, and energy in closed rooms.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "tests/runtime/radiosity_fixture.h"

namespace lightwell::test {
namespace {

/// (1 / π) ∫ max(0, cos) over the cone, the inner integral over the azimuth in closed form.
double shareByQuadrature(double distance, double radius, double cosine) {
  if (distance <= radius) return 1;
  const double widest = std::asin(radius / distance), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  constexpr int kSteps = 64;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double theta = widest * (i + 0.5) / kSteps, a = std::cos(theta) * cosine, b = std::sin(theta) * sine;
    const double end = b > 0 ? std::acos(std::clamp(-a / b, -1.0, 1.0)) : a > 0 ? std::numbers::pi : 0.0;
    sum += 2 * (a * end + b * std::sin(end)) * std::sin(theta) * widest / kSteps;
  }
  return sum / std::numbers::pi;
}

float share(const lw_blocker& blocker, const float* position, const float* normal) {
  float kept[3];
  EXPECT_EQ(lw_blockers_kept(&blocker, 1, position, normal, kept), LW_OK);
  return 1 - kept[0];
}

TEST(Blockers, FillTheShareThatQuadratureFinds) {
  std::mt19937 random(3);
  std::normal_distribution<double> gauss;
  std::uniform_real_distribution<double> unit(0, 1);
  double worst = 0;
  int below = 0, cut = 0, inside = 0;
  for (int i = 0; i < 100000; ++i) {
    double n[3], d[3], n_length = 0, d_length = 0;
    for (int k = 0; k < 3; ++k) n[k] = gauss(random), d[k] = gauss(random), n_length += n[k] * n[k], d_length += d[k] * d[k];
    // From deep inside through touching to far away; radii from millimetres to kilometres.
    const double radius = std::pow(10.0, 6 * unit(random) - 3), distance = radius * (i % 50 == 0 ? 0.5 : 1 + std::pow(10.0, 6 * unit(random) - 5));
    const float position[3] = {0, 0, 0}, normal[3] = {float(n[0] / std::sqrt(n_length)), float(n[1] / std::sqrt(n_length)), float(n[2] / std::sqrt(n_length))};
    lw_blocker blocker{};
    double cosine = 0;
    for (int k = 0; k < 3; ++k) blocker.position_m[k] = float(distance * d[k] / std::sqrt(d_length)), cosine += double(normal[k]) * d[k] / std::sqrt(d_length);
    blocker.radius_m = float(radius);
    const double expected = shareByQuadrature(distance, radius, cosine);
    worst = std::max(worst, std::abs(double(share(blocker, position, normal)) - expected));
    below += expected == 0, inside += distance < radius, cut += distance > radius && std::abs(cosine) < radius / distance;
  }
  EXPECT_LT(worst, 2e-3);  // a float just beside the surface of a large sphere is that far from it
  EXPECT_GT(below, 1000);
  EXPECT_GT(cut, 10000);
  EXPECT_GT(inside, 1000);
}

TEST(Blockers, TouchingSpheresFillHalf) {
  const float origin[3] = {0, 0, 0}, up[3] = {0, 1, 0}, side[3] = {1, 0, 0}, down[3] = {0, -1, 0};
  const lw_blocker on_top{{0, 1.00001f, 0}, 1, {0, 0, 0}};
  EXPECT_NEAR(share(on_top, origin, up), 1, 0.01);
  EXPECT_NEAR(share(on_top, origin, side), 0.5, 0.01);
  EXPECT_NEAR(share(on_top, origin, down), 0, 0.01);
  EXPECT_EQ(share({{0, 1, 0}, 0, {0, 0, 0}}, origin, up), 0);
  EXPECT_EQ(share({{0, 0, 0}, 0, {0, 0, 0}}, origin, up), 0);
  EXPECT_NEAR(share({{0, 1e12f, 0}, 1, {0, 0, 0}}, origin, up), 0, 1e-6);
}

TEST(Blockers, WhiteOnesLeaveAClosedRoomAsItWas) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {3, 2, 4}, 6, 0.8, 1);
  LoadedRoom room(options);
  const std::vector<lw_blocker> white = {{{1, 0.5f, 1}, 0.5f, {1, 1, 1}}, {{2, 1, 2.5f}, 0.8f, {1, 1, 1}}, {{0.3f, 0.2f, 3}, 0.6f, {1, 1, 1}}};
  ASSERT_EQ(lw_radiosity_set_blockers(room.state, white.data(), 3), LW_OK);
  room.solve();
  for (const float e : room.irradiance()) ASSERT_NEAR(e * 0.2 / std::numbers::pi, 1, 2e-3);
  // Black ones take light, grey ones less, and none nothing.
  double mean[3] = {};
  for (const float albedo : {0.0f, 0.5f}) {
    auto grey = white;
    for (auto& blocker : grey) std::fill_n(blocker.albedo_rgb, 3, albedo);
    ASSERT_EQ(lw_radiosity_set_blockers(room.state, grey.data(), 3), LW_OK);
    room.solve();
    for (const float e : room.irradiance()) mean[albedo > 0] += double(e);
  }
  ASSERT_EQ(lw_radiosity_set_blockers(room.state, nullptr, 0), LW_OK);
  room.solve();
  for (const float e : room.irradiance()) {
    mean[2] += double(e);
    ASSERT_NEAR(e * 0.2 / std::numbers::pi, 1, 2e-3);
  }
  EXPECT_LT(mean[0], 0.98 * mean[1]);
  EXPECT_LT(mean[1], 0.98 * mean[2]);
}

TEST(Blockers, SeveralMultiply) {
  const float origin[3] = {0, 0, 0}, up[3] = {0, 1, 0};
  const lw_blocker two[2] = {{{0, 2, 0}, 1, {0, 0, 0}}, {{1, 2, 0}, 1, {1, 0, 0.5f}}};
  float first[3], second[3], both[3];
  ASSERT_EQ(lw_blockers_kept(two, 1, origin, up, first), LW_OK);
  lw_blocker black = two[1];
  std::fill_n(black.albedo_rgb, 3, 0.0f);
  ASSERT_EQ(lw_blockers_kept(&black, 1, origin, up, second), LW_OK);
  ASSERT_EQ(lw_blockers_kept(two, 2, origin, up, both), LW_OK);
  EXPECT_NEAR(both[1], first[1] * second[1], 1e-6);
  EXPECT_GT(both[0], both[2]);
  EXPECT_GT(both[2], both[1]);
}

TEST(Blockers, RefuseWhatCannotBe) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 2, 0.5, 1);
  LoadedRoom room(options);
  const float origin[3] = {0, 0, 0}, up[3] = {0, 1, 0};
  float kept[3];
  for (const lw_blocker& wrong : {lw_blocker{{NAN, 0, 0}, 1, {0, 0, 0}}, lw_blocker{{0, 0, 0}, -1, {0, 0, 0}}, lw_blocker{{0, 0, 0}, INFINITY, {0, 0, 0}},
                                  lw_blocker{{0, 0, 0}, 1, {0, 1.5f, 0}}, lw_blocker{{0, 0, 0}, 1, {0, 0, NAN}}}) {
    EXPECT_EQ(lw_radiosity_set_blockers(room.state, &wrong, 1), LW_INVALID_ARGUMENT);
    EXPECT_EQ(lw_blockers_kept(&wrong, 1, origin, up, kept), LW_INVALID_ARGUMENT);
  }
  EXPECT_EQ(lw_radiosity_set_blockers(room.state, nullptr, 1), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_radiosity_set_blockers(nullptr, nullptr, 0), LW_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace lightwell::test
