// Injection of lamps' light on the CPU: power, places, shadows, and what a moving lamp does.
#include <cmath>
#include <cstring>
#include <numbers>

#include "tests/runtime/radiosity_fixture.h"

namespace lightwell::test {
namespace {

constexpr double kPi = std::numbers::pi;

class Injector {
 public:
  Injector(const LoadedRoom& room, uint32_t side) : room_(room) {
    EXPECT_EQ(lw_radiosity_injector_create(room.container.get(), room.radiosity, side, &injector_), LW_OK);
  }
  ~Injector() { lw_radiosity_injector_destroy(injector_); }
  Injector(const Injector&) = delete;
  Injector& operator=(const Injector&) = delete;

  std::vector<float> inject(const lw_light& light) {
    std::vector<float> rgb(size_t(room_.info.patches) * 3);
    EXPECT_EQ(lw_radiosity_inject(injector_, &light, 1, rgb.data()), LW_OK);
    return rgb;
  }
  void open(float how_far) {
    EXPECT_EQ(lw_radiosity_set_portal(room_.state, 0, how_far), LW_OK);
    EXPECT_EQ(lw_radiosity_injector_set_portals(injector_, room_.state), LW_OK);
  }
  double power(const lw_light& light, size_t channel = 0) {
    const auto rgb = inject(light);
    double sum = 0;
    for (uint32_t i = 0; i < room_.info.patches; ++i) sum += double(rgb[i * 3 + channel]) * double(room_.room.content.patch_area[i]);
    return sum;
  }

 private:
  const LoadedRoom& room_;
  lw_radiosity_injector* injector_ = nullptr;
};

class Sides : public testing::TestWithParam<uint32_t> {};

/// Nothing slips through between triangles, and the pixels' solid angles are exact.
TEST_P(Sides, HandOutAllOfTheLight) {
  LoadedRoom room(box());
  Injector injector(room, GetParam());
  const lw_light point = pointLight(0.3, 1.1, -0.4, 10);
  EXPECT_NEAR(injector.power(point) / (4 * kPi * 10), 1, 1e-5);
  lw_light spot = point;
  spot.type = LW_LIGHT_SPOT;
  spot.direction[0] = 0.3f, spot.direction[2] = 0.2f;
  for (const auto& [inner, outer] : {std::pair{0.3f, 0.31f}, {0.0f, 0.6f}, {0.2f, 0.9f}, {0.5f, 1.5f}}) {
    if (GetParam() > 1000 && outer > 0.5f) break;  // enough of the large pictures
    spot.inner_cone_angle_rad = inner, spot.outer_cone_angle_rad = outer;
    const double ci = std::cos(double(inner)), co = std::cos(double(outer));
    EXPECT_NEAR(injector.power(spot) / (10 * 2 * kPi * ((1 - ci) + (ci - co) / 3)), 1, 1e-4) << inner << " " << outer;
  }
}

INSTANTIATE_TEST_SUITE_P(Injection, Sides, testing::Values(32u, 128u, 2048u));

TEST(Injection, PutsLightWhereItFalls) {
  LoadedRoom room(box(4));
  Injector injector(room, 256);
  const lw_light point = pointLight(0.4, 1.3, 0.2, 10);
  const auto rgb = injector.inject(point);
  const format::RadiosityContent& c = room.room.content;
  lw_radiosity_patches patches;
  ASSERT_EQ(lw_radiosity_get_patches(room.radiosity, &patches), LW_OK);
  double difference = 0, square = 0;
  for (uint32_t i = 0; i < room.info.patches; ++i) {
    // Mean over the patch: the light's own flux through it, from points spread over it.
    const Wall wall = box(4).walls[room.room.wall_of_patch[i]];
    double exact = 0;
    for (int s = 0; s < 64; ++s) {
      double way[3], r2 = 0, cosine = 0;
      for (size_t k = 0; k < 3; ++k) {
        way[k] = double(point.position_m[k]) - double(c.patch_position[i * 3 + k]) - wall.a[k] / 4 * ((s % 8 + 0.5) / 8 - 0.5) - wall.b[k] / 4 * ((s / 8 + 0.5) / 8 - 0.5);
        r2 += way[k] * way[k];
        cosine += way[k] * double(patches.normal[i * 3 + k]);
      }
      exact += 10 * cosine / (r2 * std::sqrt(r2)) / 64;
    }
    difference += std::pow(double(rgb[i * 3]) - exact, 2), square += exact * exact;
  }
  EXPECT_LT(std::sqrt(difference / square), 0.01);
}

TEST(Injection, DirectionalLightFallsThroughTheRoof) {
  // A floor below a smaller roof whose upper side is lit.
  RoomOptions options;
  options.walls = {{{0, 0, 0}, {0, 0, 4}, {4, 0, 0}, 8, 0.5, 0, 0}, {{1, 1, 1}, {0, 0, 2}, {2, 0, 0}, 8, 0.5, 0, 0}};
  LoadedRoom room(options);
  lw_light sun = pointLight(0, 0, 0, 7);
  sun.type = LW_LIGHT_DIRECTIONAL;
  for (const uint32_t side : {64u, 512u}) {
    Injector injector(room, side);
    EXPECT_NEAR(injector.power(sun) / (7.0 * 16), 1, side == 64 ? 0.03 : 0.005);
    const auto rgb = injector.inject(sun);
    EXPECT_NEAR(rgb[0], 7, side == 64 ? 0.5 : 0.1);                // a corner of the floor
    EXPECT_NEAR(rgb[(3 * 8 + 3) * 3], 0, side == 64 ? 0.5 : 0.1);  // below the roof
  }
}

TEST(Injection, RangeAndBacksAbsorb) {
  LoadedRoom room(box());
  Injector injector(room, 64);
  lw_light point = pointLight(0.5, 1.2, 0, 10);
  point.range_m = 1;
  EXPECT_LT(injector.power(point), 0.1 * 4 * kPi * 10);
  // From outside only backs of single-sided walls are seen.
  EXPECT_EQ(injector.power(pointLight(50, 1, 0, 10)), 0.0);
}

/// A lamp that moves slowly: its power never changes, and what patches get changes no faster than it should.
TEST(Injection, NothingPopsUnderMotion) {
  LoadedRoom room(box(4));
  Injector coarse(room, 128), fine(room, 512);
  double worst_power = 0, pop2 = 0, light2 = 0, worst_pop = 0;
  std::vector<float> last;
  std::vector<float> last_fine;
  for (int frame = 0; frame < 8; ++frame) {
    const lw_light light = pointLight(0.2 + 0.002 * frame, 1.0 + 0.001 * frame, 0.3 - 0.0015 * frame, 10);  // 16 cm a second at 60 Hz
    if (frame % 3 == 0) worst_power = std::max(worst_power, std::abs(coarse.power(light) / (4 * kPi * 10) - 1));
    const auto now = coarse.inject(light), now_fine = fine.inject(light);
    for (size_t i = 0; i < now.size() && frame > 0; i += 3) {
      // The change beyond that of the light itself.
      const double pop = double(now[i] - last[i]) - double(now_fine[i] - last_fine[i]);
      pop2 += pop * pop, light2 += double(now[i]) * double(now[i]);
      worst_pop = std::max(worst_pop, std::abs(pop) / double(now[i]));
    }
    last = now, last_fine = now_fine;
  }
  RecordProperty("pop_relrms_ppm", int(1e6 * std::sqrt(pop2 / light2)));
  std::printf("popping of patches at 128: %.3f %% rms, %.3f %% at most; power within %.1e\n", 100 * std::sqrt(pop2 / light2), 100 * worst_pop, worst_power);
  EXPECT_LT(worst_power, 1e-5);
  EXPECT_LT(std::sqrt(pop2 / light2), 0.01);
  EXPECT_LT(worst_pop, 0.05);
}

/// Light of slivers and texels without a patch goes to their neighbours.
TEST(Injection, TexelsWithoutPatchesPassTheirLightOn) {
  SyntheticRadiosity made = makeRoom(box());
  format::RadiosityContent& c = made.content;
  for (size_t i = c.texel.size(); i-- > 0;) {
    if (i % 3 != 1) continue;
    c.texel.erase(c.texel.begin() + std::ptrdiff_t(i));
    c.texel_patch.erase(c.texel_patch.begin() + std::ptrdiff_t(i * 4), c.texel_patch.begin() + std::ptrdiff_t(i * 4 + 4));
    c.texel_weight.resize(c.texel_weight.size() - 4);
    c.texel_exposed.pop_back();
  }
  c.header.set_texels(uint32_t(c.texel.size()));
  LoadedRoom room(std::move(made));
  Injector injector(room, 64);
  EXPECT_NEAR(injector.power(pointLight(0.3, 1.1, -0.4, 10)) / (4 * kPi * 10), 1, 1e-5);
}

/// A cut-out wall in front of another: light goes where its texture has holes.
TEST(Injection, CutOutsLetLightThrough) {
  RoomOptions options;
  options.walls = {{{0, 0, 0}, {0, 0, 4}, {4, 0, 0}, 4, 0.5, 0, 0}, {{1, 1, 1}, {0, 0, 2}, {2, 0, 0}, 4, 0.5, 0, 0}};
  const auto powerOnFloor = [&](bool cut_out) {
    SyntheticRadiosity made = makeRoom(options);
    format::RadiosityContent& c = made.content;
    if (cut_out) {
      for (const char* chunk : {"alpha_uv", "triangle_alpha", "alpha_material", "alpha_texture_0"}) c.base.left_out.erase(std::string("geometry/") + chunk);
      c.base.triangle_flags = {0, 0, LW_TRIANGLE_CUT_OUT, LW_TRIANGLE_CUT_OUT};
      c.base.triangle_alpha = {0xffff, 0xffff, 0, 0};
      c.base.alpha_uv = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 1, 0, 1};
      c.base.alpha_texture = {0, 255, 0, 255};  // half of it
      c.base.alpha_material.mutable_materials(0)->set_wrap_u(v1::WRAP_MODE_CLAMP);
    }
    LoadedRoom room(std::move(made));
    Injector injector(room, 256);
    lw_light sun = pointLight(0, 0, 0, 1);
    sun.type = LW_LIGHT_DIRECTIONAL;
    const auto rgb = injector.inject(sun);
    double sum = 0;
    for (uint32_t i = 0; i < 16; ++i) sum += double(rgb[i * 3]) * double(room.room.content.patch_area[i]);
    return sum;
  };
  EXPECT_NEAR(powerOnFloor(false), 12, 0.15);
  EXPECT_NEAR(powerOnFloor(true), 14, 0.15);
}

TEST(Injection, RefusesWhatCannotBe) {
  LoadedRoom room(box(2));
  lw_radiosity_injector* injector = nullptr;
  EXPECT_EQ(lw_radiosity_injector_create(room.container.get(), room.radiosity, 4, &injector), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_radiosity_injector_create(room.container.get(), room.radiosity, 5000, &injector), LW_INVALID_ARGUMENT);
  ASSERT_EQ(lw_radiosity_injector_create(room.container.get(), room.radiosity, 16, &injector), LW_OK);
  std::vector<float> rgb(size_t(room.info.patches) * 3);
  lw_light light = pointLight(0, 1, 0, 1);
  light.intensity_rgb[1] = NAN;
  EXPECT_EQ(lw_radiosity_inject(injector, &light, 1, rgb.data()), LW_INVALID_ARGUMENT);
  // On a wall, in a corner, far away: whatever it is, it is finite.
  for (const double at : {0.0, 2.5, 1e30, -1e30}) {
    light = pointLight(-1, at, -2, 1e20);
    ASSERT_EQ(lw_radiosity_inject(injector, &light, 1, rgb.data()), LW_OK);
    for (const float e : rgb) ASSERT_TRUE(std::isfinite(e) && e >= 0);
  }
  lw_radiosity_injector_destroy(injector);
}

/// What is left of a leaf takes exactly the light that it took when it was shut; the rest goes on, and none is lost.
TEST(LeafInjection, MovesWithTheDoorsEdge) {
  LoadedRoom room(boxWithLeaf());
  Injector injector(room, 256);
  const lw_light lamp = pointLight(-0.4, 1.2, 0.1, 10);
  const auto leafPower = [&](const std::vector<float>& rgb, double from, double to) {
    double sum = 0;
    for (uint32_t i = 0; i < room.info.patches; ++i) {
      const double s = (double(room.room.content.patch_position[i * 3 + 2]) + 2) / 4;
      if (room.room.wall_of_patch[i] == 6 && s > from && s < to) sum += double(rgb[i * 3]) * double(room.room.content.patch_area[i]);
    }
    return sum;
  };
  const auto shut = injector.inject(lamp);
  const double whole = injector.power(lamp);
  EXPECT_NEAR(whole / (4 * kPi * 10), 1, 1e-3);
  EXPECT_GT(leafPower(shut, 0, 1), 10);
  double last = leafPower(shut, 0, 1);
  for (const float open : {0.0f, 0.1f, 0.25f, 0.3f, 0.5f, 0.62f, 0.75f, 1.0f}) {
    injector.open(open);
    const auto rgb = injector.inject(lamp);
    EXPECT_NEAR(injector.power(lamp) / whole, 1, 1e-4) << open;
    EXPECT_NEAR(leafPower(rgb, std::ceil(double(open) * 4) / 4, 1), leafPower(shut, std::ceil(double(open) * 4) / 4, 1), 1e-4) << open;
    EXPECT_NEAR(leafPower(rgb, 0, std::floor(double(open) * 4) / 4), 0, 1e-6) << open;
    EXPECT_LE(leafPower(rgb, 0, 1), last + 1e-6) << open;
    last = leafPower(rgb, 0, 1);
  }
  // Not in steps of strips.
  injector.open(0.30f);
  const double before = leafPower(injector.inject(lamp), 0, 1);
  injector.open(0.31f);
  const double after = leafPower(injector.inject(lamp), 0, 1);
  EXPECT_LT(after, before - 1e-3 * whole);
  EXPECT_GT(after, before - 2e-2 * whole);
}

}  // namespace
}  // namespace lightwell::test
