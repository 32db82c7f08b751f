// Radiosity on the CPU: closed rooms whose light is known, doors, materials, and the solver against elimination in double precision.
#include <cmath>
#include <numbers>

#include "tests/runtime/radiosity_fixture.h"

namespace lightwell::test {
namespace {

constexpr double kPi = std::numbers::pi;

RoomOptions cube(double albedo, double emission, bool merge = true) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 4, albedo, emission);
  options.merge = merge;
  return options;
}

/// Walls of different colours, lamps on the ceiling.
RoomOptions colouredRoom(double albedo) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {3, 2, 4}, 5, albedo, 0);
  options.walls[0].albedo *= 0.7;
  options.walls[1].albedo *= 0.3;
  options.walls[3].emission = 2;
  options.merge = true;
  return options;
}

/// Two boxes that see each other through a door in walls 1 and 6. Sets: 1 open, 2 closed for each of the two strips; a ray that meets the closed door sees its wall.
RoomOptions twoRooms(double albedo) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 4, albedo, 0);
  for (const Wall& wall : boxWalls({1, 0, 0}, {2, 1, 1}, 4, albedo, 0)) options.walls.push_back(wall);
  options.walls[2].emission = 1;  // the first room's floor
  options.walls[1].cells = options.walls[6].cells = 2;
  options.strips = 2;
  options.gate_sets = {{}, {0}, {1}};
  const auto room = [](uint32_t wall) { return wall / 6; };
  // The walls between hide a little of what is behind; rows are scaled to 1 with links through the door counted once.
  options.visible = [=](uint32_t to, uint32_t from) { return room(to) == room(from) ? 1.0 : to == 1 || to == 6 || from == 1 || from == 6 ? 0.0 : 0.25; };
  options.gate_set = [=](uint32_t to, uint32_t from) { return uint16_t(room(to) == room(from) ? 0 : 1); };
  return options;
}

double relrmse(const std::vector<float>& rgb, const std::vector<double>& exact, int channel = 0) {
  double difference = 0, square = 0;
  for (size_t i = 0; i < exact.size(); ++i) {
    const double d = double(rgb[i * 3 + size_t(channel)]) - exact[i];
    difference += d * d, square += exact[i] * exact[i];
  }
  return std::sqrt(difference / square);
}

class ClosedCube : public testing::TestWithParam<double> {};

TEST_P(ClosedCube, GivesPiOverOneMinusAlbedo) {
  const double albedo = GetParam();
  LoadedRoom cube_room(cube(albedo, 1));
  const lw_radiosity_report report = cube_room.solve();
  EXPECT_LE(report.residual, 1e-6) << report.sweeps;
  EXPECT_LE(report.sweeps, 40u);
  for (const float e : cube_room.irradiance()) ASSERT_NEAR(e * (1 - albedo) / kPi, 1, albedo > 0.99 ? 2e-3 : 2e-4);
}

INSTANTIATE_TEST_SUITE_P(Albedo, ClosedCube, testing::Values(0.0, 0.5, 0.9, 0.99, 0.999));

/// n sweeps from the dark are n bounces.
TEST(Radiosity, StepsAreBounces) {
  LoadedRoom room(cube(0.5, 1));
  double sum = 0, bounce = kPi;
  for (int n = 1; n <= 6; ++n, bounce *= 0.5) {
    ASSERT_EQ(lw_radiosity_step(room.state, 1), LW_OK);
    sum += bounce;
    for (const float e : room.irradiance()) ASSERT_NEAR(e / sum, 1, 1e-5) << n;
  }
  EXPECT_EQ(lw_radiosity_step(room.state, 60), LW_OK);
  for (const float e : room.irradiance()) ASSERT_NEAR(e / (2 * kPi), 1, 1e-5);
}

class AgainstDouble : public testing::TestWithParam<double> {};

TEST_P(AgainstDouble, AgreesWithElimination) {
  LoadedRoom room(colouredRoom(GetParam()));
  const std::vector<Wall> walls = colouredRoom(GetParam()).walls;
  const uint32_t patches = room.info.patches;
  std::vector<float> direct(size_t(patches) * 3);
  std::vector<double> albedo, exact_direct, emission;
  for (uint32_t i = 0; i < patches; ++i) {
    const Wall& wall = walls[room.room.wall_of_patch[i]];
    direct[i * 3] = i % 7 == 0 ? 3.0f : 0.0f;
    albedo.push_back(double(float(wall.albedo))), emission.push_back(wall.emission), exact_direct.push_back(double(direct[i * 3]));
  }
  ASSERT_EQ(lw_radiosity_set_direct(room.state, direct.data()), LW_OK);
  const lw_radiosity_report report = room.solve();
  EXPECT_LE(report.sweeps, 60u) << report.residual;
  const std::vector<double> exact = room.room.solve(albedo, exact_direct, emission), dark(patches, 0.0);
  EXPECT_LT(relrmse(room.irradiance(), exact), 2e-6 / (1.0 - GetParam() * 0.9));
  EXPECT_LT(relrmse(room.irradiance(), room.room.solve(albedo, dark, emission), 1), 2e-6 / (1.0 - GetParam() * 0.9));
}

INSTANTIATE_TEST_SUITE_P(Albedo, AgainstDouble, testing::Values(0.3, 0.9, 0.999));

TEST(Radiosity, AmountsOfLightAddUp) {
  LoadedRoom room(colouredRoom(0.8));
  room.solve();
  const auto all = room.irradiance(), indirect = room.irradiance(LW_RADIOSITY_INDIRECT), emitters = room.irradiance(LW_RADIOSITY_EMITTERS);
  double most = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    ASSERT_NEAR(all[i], indirect[i] + emitters[i], 1e-5);
    most = std::max(most, double(indirect[i]));
  }
  EXPECT_GT(most, 0.1);
  // Straight from the ceiling: what one sweep over black walls gives.
  lw_radiosity_material black = LW_RADIOSITY_MATERIAL_INIT;
  for (float& f : black.albedo_factor_rgb) f = 0;
  ASSERT_EQ(lw_radiosity_set_material(room.state, 0, &black), LW_OK);
  room.solve();
  const auto first = room.irradiance();
  for (size_t i = 0; i < all.size(); ++i) ASSERT_NEAR(first[i], emitters[i], 1e-5);
  // The lights' own light is added as it was given.
  std::vector<float> direct(all.size(), 0.25f);
  ASSERT_EQ(lw_radiosity_set_direct(room.state, direct.data()), LW_OK);
  const auto lit = room.irradiance(LW_RADIOSITY_LIGHTS | LW_RADIOSITY_EMITTERS);
  for (size_t i = 0; i < all.size(); ++i) ASSERT_NEAR(lit[i], emitters[i] + 0.25f, 1e-5);
}

TEST(Radiosity, DoorsOpenAndClose) {
  LoadedRoom rooms(twoRooms(0.7));
  lw_radiosity_portal door;
  ASSERT_EQ(lw_radiosity_get_portal(rooms.radiosity, 0, &door), LW_OK);
  EXPECT_STREQ(door.name, "door");
  EXPECT_EQ(door.gates, 2u);
  const auto second = [&] {
    rooms.solve();
    double sum = 0;
    const auto e = rooms.irradiance();
    for (uint32_t i = 0; i < rooms.info.patches; ++i) sum += rooms.room.wall_of_patch[i] >= 6 ? double(e[i * 3]) : 0;
    return sum;
  };
  EXPECT_EQ(second(), 0.0) << "doors are shut as they were baked";
  ASSERT_EQ(lw_radiosity_set_portal(rooms.state, 0, 1), LW_OK);
  const double open = second();
  EXPECT_GT(open, 0.01);
  ASSERT_EQ(lw_radiosity_set_portal(rooms.state, 0, 0), LW_OK);
  // Light that was there before the door closed dies away; from the dark there is none at all.
  EXPECT_LT(second(), 1e-5 * open);
  lw_radiosity_state* fresh = nullptr;
  ASSERT_EQ(lw_radiosity_state_create(rooms.radiosity, &fresh), LW_OK);
  std::swap(fresh, rooms.state);
  lw_radiosity_state_destroy(fresh);
  ASSERT_EQ(lw_radiosity_set_portal(rooms.state, 0, 0), LW_OK);
  EXPECT_EQ(second(), 0.0);

  // Half open: the first strip, which all links here cross. Its factor is the share of it that is open.
  std::vector<double> albedo, none(rooms.info.patches, 0.0), emission;
  for (uint32_t i = 0; i < rooms.info.patches; ++i) albedo.push_back(double(0.7f)), emission.push_back(rooms.room.wall_of_patch[i] == 2 ? 1 : 0);
  for (const auto& [share, factor] : {std::pair{0.25f, 0.5}, {0.5f, 1.0}, {0.1f, 0.2}}) {
    ASSERT_EQ(lw_radiosity_set_portal(rooms.state, 0, share), LW_OK);
    rooms.solve();
    EXPECT_LT(relrmse(rooms.irradiance(), rooms.room.solve(albedo, none, emission, {1, factor, 1 - factor})), 1e-5) << share;
  }
  ASSERT_EQ(lw_radiosity_set_gate(rooms.state, 0, 0.75f), LW_OK);
  rooms.solve();
  EXPECT_LT(relrmse(rooms.irradiance(), rooms.room.solve(albedo, none, emission, {1, 0.75, 0.25})), 1e-5);
}

/// A set's factors multiply: two half open gates behind each other let a quarter through, and one that must be closed the rest of it.
TEST(Radiosity, GatesMultiply) {
  for (const auto& [set, factor] : {std::pair{std::vector<uint16_t>{0, 2}, 0.5 * 0.25}, {{0, 3}, 0.5 * 0.75}, {{1, 3}, 0.5 * 0.75}}) {
    RoomOptions options = twoRooms(0.5);
    options.gate_sets = {{}, set};
    LoadedRoom rooms(options);
    ASSERT_EQ(lw_radiosity_set_gate(rooms.state, 0, 0.5f), LW_OK);
    ASSERT_EQ(lw_radiosity_set_gate(rooms.state, 1, 0.25f), LW_OK);
    std::vector<double> albedo(rooms.info.patches, 0.5), none(rooms.info.patches, 0.0), emission;
    for (uint32_t i = 0; i < rooms.info.patches; ++i) emission.push_back(rooms.room.wall_of_patch[i] == 2 ? 1 : 0);
    rooms.solve();
    EXPECT_LT(relrmse(rooms.irradiance(), rooms.room.solve(albedo, none, emission, {1, factor})), 1e-5);
  }
}

/// The stiffest case: two bright rooms that hardly see each other, each a slow mode of its own.
TEST(Radiosity, ConvergesInBrightRoomsBehindADoor) {
  RoomOptions options = twoRooms(0.999);
  LoadedRoom rooms(options);
  ASSERT_EQ(lw_radiosity_set_portal(rooms.state, 0, 0.05f), LW_OK);
  const lw_radiosity_report report = rooms.solve(1e-6);
  EXPECT_LE(report.sweeps, 60u);
  EXPECT_LE(report.residual, 2e-6);
  std::vector<double> albedo(rooms.info.patches, double(0.999f)), none(rooms.info.patches, 0.0), emission;
  for (uint32_t i = 0; i < rooms.info.patches; ++i) emission.push_back(rooms.room.wall_of_patch[i] == 2 ? 1 : 0);
  EXPECT_LT(relrmse(rooms.irradiance(), rooms.room.solve(albedo, none, emission, {1, 0.1, 0.9})), 5e-3);
}

TEST(Radiosity, MaterialsChange) {
  RoomOptions options = cube(0.5, 1);
  options.walls[0].material = 1;
  options.materials = 2;
  LoadedRoom room(options);
  EXPECT_STREQ(lw_radiosity_material_name(room.radiosity, 1), "material 1");
  EXPECT_EQ(lw_radiosity_material_name(room.radiosity, 2), nullptr);
  // Half the albedo, twice the emission: π · 2 / (1 − 0.25) once all walls have it.
  lw_radiosity_material material = LW_RADIOSITY_MATERIAL_INIT;
  for (int k = 0; k < 3; ++k) material.albedo_factor_rgb[k] = 0.5f, material.emission_factor_rgb[k] = 0, material.emission_rgb[k] = 2;
  ASSERT_EQ(lw_radiosity_set_material(room.state, 0, &material), LW_OK);
  room.solve();
  EXPECT_LT(room.irradiance()[0], 2 * kPi / 0.75);  // one wall is still as it was
  ASSERT_EQ(lw_radiosity_set_material(room.state, 1, &material), LW_OK);
  room.solve();
  for (const float e : room.irradiance()) ASSERT_NEAR(e / (2 * kPi / 0.75), 1, 1e-5);
  // Whiter than possible is as white as can be.
  for (float& a : material.albedo_rgb) a = 7;
  for (uint32_t m = 0; m < 2; ++m) ASSERT_EQ(lw_radiosity_set_material(room.state, m, &material), LW_OK);
  room.solve();
  for (const float e : room.irradiance()) ASSERT_NEAR(e / (2 * kPi / 0.001), 1, 2e-3);
}

TEST(Radiosity, TexelsMixPatchesAndKnowTheirExposure) {
  SyntheticRadiosity made = makeRoom(colouredRoom(0.5));
  format::RadiosityContent& c = made.content;
  c.texel_patch = std::vector<uint32_t>(c.texel_patch);
  c.texel_patch[1] = c.texel_patch[4];
  c.texel_weight[0] = 155, c.texel_weight[1] = 100;
  c.texel_exposed[0] = 51;
  const uint32_t first = c.texel[0], second = c.texel[1], gutter = uint32_t(c.base.source.size() - 1);
  ASSERT_EQ(c.base.source[gutter], 0xffffffffu);
  c.base.source[gutter] = first;
  LoadedRoom room(std::move(made));
  room.solve();
  const auto e = room.irradiance();
  const uint32_t* patch = room.room.content.texel_patch.data();
  std::vector<float> atlas(size_t(room.info.width) * room.info.height * 4, -1.0f);
  lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
  ASSERT_EQ(lw_radiosity_shade(room.state, &shading, atlas.data()), LW_OK);
  const double mixed = (155.0 * double(e[patch[0] * 3]) + 100.0 * double(e[patch[4] * 3])) / 255;
  EXPECT_NEAR(atlas[first * 4] / mixed, 1, 1e-5);
  EXPECT_NEAR(atlas[second * 4], e[patch[4] * 3], 1e-5);
  EXPECT_EQ(atlas[gutter * 4], atlas[first * 4]);
  EXPECT_EQ(atlas[gutter * 4 + 3], 1.0f);
  shading.fill = 0;
  ASSERT_EQ(lw_radiosity_shade(room.state, &shading, atlas.data()), LW_OK);
  EXPECT_NEAR(atlas[first * 4] / (mixed * 0.2), 1, 1e-5);
  EXPECT_EQ(atlas[gutter * 4 + 3], 0.0f);
}

}  // namespace
}  // namespace lightwell::test
