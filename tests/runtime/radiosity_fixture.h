// Loaded form factors and their state, with owners.
#pragma once
#include "tests/runtime/support.h"
#include "tests/runtime/synthetic_radiosity.h"

namespace lightwell::test {

struct LoadedRoom {
  explicit LoadedRoom(const RoomOptions& options) : LoadedRoom(makeRoom(options)) {}
  explicit LoadedRoom(SyntheticRadiosity made) : room(std::move(made)), bytes(room.bytes()), container(openMemory(bytes)) {
    EXPECT_EQ(lw_radiosity_load(container.get(), &radiosity), LW_OK);
    EXPECT_EQ(lw_radiosity_state_create(radiosity, &state), LW_OK);
    EXPECT_EQ(lw_radiosity_get_info(radiosity, &info), LW_OK);
  }
  ~LoadedRoom() {
    lw_radiosity_state_destroy(state);
    lw_radiosity_release(radiosity);
  }
  LoadedRoom(const LoadedRoom&) = delete;
  LoadedRoom& operator=(const LoadedRoom&) = delete;

  /// [patches][3].
  std::vector<float> irradiance(uint32_t light = LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS) {
    std::vector<float> rgb(size_t(info.patches) * 3);
    EXPECT_EQ(lw_radiosity_get_irradiance(state, light, rgb.data()), LW_OK);
    return rgb;
  }
  lw_radiosity_report solve(double tolerance = 1e-7, uint32_t most = 500) {
    lw_radiosity_report report{};
    EXPECT_EQ(lw_radiosity_solve(state, tolerance, most, &report), LW_OK);
    return report;
  }

  SyntheticRadiosity room;
  std::vector<uint8_t> bytes;
  Container container;
  lw_radiosity* radiosity = nullptr;
  lw_radiosity_state* state = nullptr;
  lw_radiosity_info info{};
};

/// A box of 3 × 2.5 × 4 m, no light inside.
inline RoomOptions box(uint32_t cells = 5) {
  RoomOptions options;
  options.walls = boxWalls({-1, 0, -2}, {2, 2.5, 2}, cells, 0.5, 0);
  return options;
}

/// A box with a leaf across it, 4 × 4 patches, that opens along +z.
inline RoomOptions boxWithLeaf() {
  RoomOptions options = box(4);
  options.walls.push_back({{0.5, 0, -2}, {0, 0, 4}, {0, 2.5, 0}, 4, 0.5, 0});
  options.strips = 8;
  options.leaf_wall = 6;
  options.gate_sets = {{}};
  return options;
}

/// One, two and three times as many candela in red, green and blue.
inline lw_light pointLight(double x, double y, double z, double candela) {
  lw_light light{};
  light.type = LW_LIGHT_POINT;
  light.position_m[0] = float(x), light.position_m[1] = float(y), light.position_m[2] = float(z);
  light.direction[1] = -1;
  light.outer_cone_angle_rad = 0.6f;
  for (int k = 0; k < 3; ++k) light.intensity_rgb[k] = float(candela * (k + 1));
  return light;
}

}  // namespace lightwell::test
