// Doors in radiosity against path tracing, however far they are open.
#include <cstdio>

#include "tests/transport/baked_doors.h"

namespace lightwell::transport {
namespace {

TEST(Portals, LightIsThatOfPathTracingHoweverFarTheDoorIsOpen) {
  const Baked b(test::roomsInARow());
  for (const float open : {0.0f, 0.5f, 0.7f, 1.0f}) {
    const auto references = b.reference(kLamp, {open}, open > 0 ? 192 : 64);
    const auto candidate = b.indirect(kLamp, {open});
    const PooledError everywhere = b.error(references, candidate, -1);
    EXPECT_LT(everywhere.relrmse, 0.05) << "open " << open;
    EXPECT_NEAR(everywhere.bias, 0, 0.015) << "open " << open;
    std::printf("open %.1f: everywhere relrmse %.3f, texrel %.3f, bias %+.4f", open, everywhere.relrmse, everywhere.texrel, everywhere.bias);
    if (open == 0) {
      std::printf("\n");
      continue;
    }
    const PooledError dark = b.error(references, candidate, 1);
    std::printf("; behind the door relrmse %.3f, texrel %.3f, bias %+.4f\n", dark.relrmse, dark.texrel, dark.bias);
    EXPECT_LT(dark.relrmse, 0.05) << "open " << open;
    EXPECT_NEAR(dark.bias, 0, 0.03) << "open " << open;
  }
}

TEST(Portals, DoorsInARowMultiply) {
  const Baked b(test::roomsInARow({.doors = 2, .strips = 3}), 256, 96);
  const auto sumOfRoom = [&](const std::vector<float>& open, int room) {
    const auto irradiance = b.indirect(kLamp, open);
    double sum = 0;
    for (size_t slot = 0; slot < irradiance.size(); ++slot)
      if (test::roomOf(b.p.atlas.slots[slot].position) == room) sum += double(irradiance[slot].x);
    return sum;
  };
  EXPECT_EQ(sumOfRoom({0, 1}, 2), 0);
  EXPECT_EQ(sumOfRoom({1, 0}, 2), 0);
  EXPECT_GT(sumOfRoom({1, 0}, 1), 0);
  const std::vector<float> half = {0.5f, 0.6f};
  const auto references = b.reference(kLamp, half, 256);
  EXPECT_LT(b.error(references, b.indirect(kLamp, half), -1).relrmse, 0.05);
  EXPECT_NEAR(b.error(references, b.indirect(kLamp, half), 2).bias, 0, 0.1);
}

TEST(Portals, SheetsAreDoorsToo) {
  const Baked b(test::roomsInARow({.strips = 4, .thickness = 0}), 512, 64);
  const auto shut = b.indirect(kLamp, {0.0f});
  for (size_t slot = 0; slot < shut.size(); ++slot)
    if (test::roomOf(b.p.atlas.slots[slot].position) == 1) {
      ASSERT_EQ(shut[slot], Rgb(0.0f)) << "texel " << b.p.atlas.slots[slot].texel;
    }
  const auto references = b.reference(kLamp, {0.75f}, 192);
  EXPECT_LT(b.error(references, b.indirect(kLamp, {0.75f}), -1).relrmse, 0.05);
  EXPECT_LT(b.error(references, b.indirect(kLamp, {0.75f}), 1).relrmse, 0.08);
}

}  // namespace
}  // namespace lightwell::transport
