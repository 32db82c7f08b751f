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

}  // namespace lightwell::test
