// Section "radiosity" from strangers: everything that evaluation relies on is refused when it is wrong, and what is let in stays finite.
#include <cmath>
#include <functional>
#include <limits>

#include "tests/runtime/radiosity_fixture.h"

namespace lightwell::test {
namespace {

using Content = format::RadiosityContent;

lw_result load(const std::vector<uint8_t>& bytes, std::string* message = nullptr, size_t fail_at = SIZE_MAX) {
  Host host;
  const lw_config config = host.config();
  lw_radiosity* radiosity = nullptr;
  lw_container* container = nullptr;
  EXPECT_EQ(lw_open_memory(bytes.data(), bytes.size(), &config, &container), LW_OK);
  host.fail_at = fail_at == SIZE_MAX ? SIZE_MAX : host.allocations + fail_at;
  const lw_result result = lw_radiosity_load(container, &radiosity);
  if (message) *message = host.message;
  lw_radiosity_release(radiosity);
  lw_close(container);
  EXPECT_EQ(host.live, 0u);
  return result;
}

TEST(RadiosityHostile, RefusesValuesThatCannotBe) {
  const std::pair<const char*, std::function<void(Content&)>> breaches[] = {
      {"patches", [](Content& c) { c.header.set_patches(10); }},
      {"no patches", [](Content& c) { c.header.set_patches(0); }},
      {"far too many patches", [](Content& c) { c.header.set_patches(0xffffffffu); }},
      {"far too many texels", [](Content& c) { c.header.set_texels(0xffffffffu); }},
      {"no materials", [](Content& c) { c.header.clear_materials(); }},
      {"portal", [](Content& c) { c.header.mutable_portals(0)->set_first_gate(7); }},
      {"strips", [](Content& c) { c.header.mutable_portals(0)->set_strips(0xffffffffu); }},
      {"leaf axis", [](Content& c) { c.header.mutable_portals(0)->set_axis(1, INFINITY); }},
      {"portal without gates", [](Content& c) { c.left_out = {"link_gates"}; }},
      {"area", [](Content& c) { c.patch_area[3] = 0; }},
      {"position", [](Content& c) { c.patch_position[3] = NAN; }},
      {"material", [](Content& c) { c.patch_material[3] = 2; }},
      {"albedo", [](Content& c) { c.patch_albedo[3] = 1; }},
      {"albedo nan", [](Content& c) { c.patch_albedo[3] = NAN; }},
      {"node", [](Content& c) { c.link_node[2] = 11; }},
      {"node huge", [](Content& c) { c.link_node[2] = 0xffffffffu; }},
      {"first", [](Content& c) { c.link_first[2] = 0x80000000u; }},
      {"scale", [](Content& c) { c.row_scale[2] = 1; }},
      {"scale nan", [](Content& c) { c.row_scale[2] = NAN; }},
      {"gates", [](Content& c) { c.link_gates[1] = 4; }},
      {"gate", [](Content& c) { c.gate_set[1] = 4; }},
      {"set 0", [](Content& c) { c.gate_set_first = {0, 1, 1, 2, 4}; }},
      {"sets", [](Content& c) { c.gate_set_first = {0, 0, 9, 2, 4}; }},
      {"texel", [](Content& c) { c.texel[2] = 16; }},
      {"texel twice", [](Content& c) { c.texel[1] = 0; }},
      {"texel's patch", [](Content& c) { c.texel_patch[1] = 9; }},
      {"texel without patch", [](Content& c) { c.texel_patch[0] = 0xffffffffu; }},
      {"back", [](Content& c) { c.texel_back_patch[1] = 9; }},
      {"short", [](Content& c) { c.texel_weight.resize(8); }},
      {"missing", [](Content& c) { c.left_out = {"link_code"}; }},
  };
  EXPECT_EQ(load(toWriter(format::portalsContent()).bytes()), LW_OK);
  EXPECT_EQ(load(toWriter(format::radiosityContent()).bytes()), LW_OK);
  for (const auto& [name, spoil] : breaches) {
    Content content = format::portalsContent();
    spoil(content);
    std::string message;
    EXPECT_EQ(load(toWriter(content).bytes(), &message), LW_BAD_SECTION) << name << ": " << message;
  }
  EXPECT_EQ(load(format::toWriter(format::panesContent()).bytes()), LW_NOT_FOUND);
}

TEST(RadiosityHostile, SurvivesEveryFailedAllocation) {
  const auto bytes = toWriter(format::portalsContent()).bytes();
  size_t failures = 0;
  while (load(bytes, nullptr, failures) == LW_OUT_OF_MEMORY) ++failures;
  EXPECT_GT(failures, 15u);
  EXPECT_EQ(load(bytes, nullptr, failures), LW_OK);
}

/// Rows that give back more than they get, as a file may say: light grows without end, up to a bound.
TEST(RadiosityHostile, RowsThatGainStayFinite) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 4, 0.999, 1);
  SyntheticRadiosity made = makeRoom(options);
  for (float& s : made.content.row_scale) s = 0.06f;
  LoadedRoom room(std::move(made));
  const std::vector<float> blinding(size_t(room.info.patches) * 3, LW_RADIOSITY_MOST);
  ASSERT_EQ(lw_radiosity_set_direct(room.state, blinding.data()), LW_OK);
  room.solve(1e-9, 100);
  for (const float e : room.irradiance()) ASSERT_TRUE(std::isfinite(e) && e >= 0);
  ASSERT_EQ(lw_radiosity_step(room.state, 100), LW_OK);
  std::vector<float> atlas(size_t(room.info.width) * room.info.height * 4);
  ASSERT_EQ(lw_radiosity_shade(room.state, nullptr, atlas.data()), LW_OK);
  for (const float v : atlas) ASSERT_TRUE(std::isfinite(v) && v >= 0);
}

TEST(RadiosityHostile, RefusesBadArguments) {
  RoomOptions options;
  options.walls = boxWalls({0, 0, 0}, {1, 1, 1}, 2, 0.5, 1);
  LoadedRoom room(options);
  std::vector<float> direct(size_t(room.info.patches) * 3, 1.0f), atlas(size_t(room.info.width) * room.info.height * 4);
  for (const float bad : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 2e24f}) {
    direct[5] = bad;
    EXPECT_EQ(lw_radiosity_set_direct(room.state, direct.data()), LW_INVALID_ARGUMENT);
    lw_radiosity_material material = LW_RADIOSITY_MATERIAL_INIT;
    material.emission_rgb[1] = bad;
    EXPECT_EQ(lw_radiosity_set_material(room.state, 0, &material), LW_INVALID_ARGUMENT);
    EXPECT_EQ(lw_radiosity_solve(room.state, bad == bad && bad > 0 ? -bad : bad, 1, nullptr), LW_INVALID_ARGUMENT);
  }
  const lw_radiosity_material material = LW_RADIOSITY_MATERIAL_INIT;
  EXPECT_EQ(lw_radiosity_set_material(room.state, 1, &material), LW_NOT_FOUND);
  EXPECT_EQ(lw_radiosity_set_portal(room.state, 0, 1), LW_NOT_FOUND);
  EXPECT_EQ(lw_radiosity_set_gate(room.state, 0, 1), LW_NOT_FOUND);
  EXPECT_EQ(lw_radiosity_get_irradiance(room.state, 8, direct.data()), LW_INVALID_ARGUMENT);
  lw_radiosity_shading shading = LW_RADIOSITY_SHADING_INIT;
  shading.fill = 2;
  EXPECT_EQ(lw_radiosity_shade(room.state, &shading, atlas.data()), LW_INVALID_ARGUMENT);
  shading.fill = 0, shading.light = 8;
  EXPECT_EQ(lw_radiosity_shade(room.state, &shading, atlas.data()), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_radiosity_load(nullptr, nullptr), LW_INVALID_ARGUMENT);
  EXPECT_EQ(lw_radiosity_step(nullptr, 1), LW_INVALID_ARGUMENT);
  lw_radiosity_release(nullptr);
  lw_radiosity_state_destroy(nullptr);
}

}  // namespace
}  // namespace lightwell::test
