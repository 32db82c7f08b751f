// Entries that are rectangles: a light near one gives it the mean over its surface, whose closed form is the solid angle.
#include <gtest/gtest.h>

#include "tests/runtime/rectangle_entries.h"
#include "tests/runtime/support.h"

namespace lightwell::test {
namespace {

class RectangleLight : public testing::TestWithParam<RectangleEntries::Vector> {
 protected:
  RectangleLight() : rectangle(GetParam()) {
    const SyntheticPrm synthetic = makeSyntheticPrm(rectangle.options());
    const Container container = openMemory(synthetic.container);
    prm = loadPrm(container.get());
    irradiance.resize(size_t(synthetic.entries()) * 3);
  }
  static lw_light candela(std::array<float, 3> position_m) {
    lw_light light{};
    light.type = LW_LIGHT_POINT;
    std::copy_n(position_m.begin(), 3, light.position_m);
    std::fill_n(light.intensity_rgb, 3, 1.0f);
    return light;
  }
  double shine(const lw_light& light) {
    EXPECT_EQ(lw_prm_entry_irradiance(prm.get(), &light, 1, nullptr, nullptr, irradiance.data()), LW_OK);
    return irradiance[1];
  }
  double meanOfQuarters() const { return (double(irradiance[4]) + irradiance[7] + irradiance[10] + irradiance[13]) / 4; }
  const RectangleEntries rectangle;
  Prm prm{nullptr, lw_prm_release};
  std::vector<float> irradiance;
};
INSTANTIATE_TEST_SUITE_P(Normals, RectangleLight, testing::ValuesIn(kRectangleNormals));

TEST_P(RectangleLight, AboveTheMiddleIsTheArcsineOfTheSides) {
  const double a = RectangleEntries::kHalfU_m, b = RectangleEntries::kHalfV_m;
  for (const double h : {1e-3, 0.01, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0}) {
    const double expected = std::asin(a * b / std::sqrt((a * a + h * h) * (b * b + h * h))) / (a * b);
    ASSERT_NEAR(RectangleEntries::meanIrradiance(0, 0, h), expected, 1e-6 * expected);
    EXPECT_NEAR(shine(candela(rectangle.at(0, 0, h))), expected, 2e-3 * expected) << h;
  }
}

/// No flux is lost or invented by how finely a surface is cut, however near the light is.
TEST_P(RectangleLight, QuartersReceiveTheFluxOfTheWhole) {
  double worst = 0, worst_sum = 0;
  for (const auto& [u, v, h] : RectangleEntries::lightPlaces(500)) {
    const double whole = shine(candela(rectangle.at(u, v, h))), expected = RectangleEntries::meanIrradiance(u, v, h);
    worst = std::max(worst, std::abs(whole / expected - 1));
    worst_sum = std::max(worst_sum, std::abs(meanOfQuarters() / whole - 1));
  }
  RecordProperty("worst", std::to_string(worst));
  RecordProperty("worst_sum", std::to_string(worst_sum));
  EXPECT_LT(worst, 5e-4);
  EXPECT_LT(worst_sum, 5e-4);
}

TEST_P(RectangleLight, TheSidesLieAsTheTurnSays) {
  // Far along the longer side and far along the shorter: only the frame tells them apart.
  for (const auto& [u, v] : {std::pair(0.6, 0.0), std::pair(0.0, 0.6)}) {
    const double expected = RectangleEntries::meanIrradiance(u, v, 0.05);
    EXPECT_NEAR(shine(candela(rectangle.at(u, v, 0.05))), expected, 2e-3 * expected);
  }
  EXPECT_GT(RectangleEntries::meanIrradiance(0.6, 0, 0.05), 1.5 * RectangleEntries::meanIrradiance(0, 0.6, 0.05));
}

TEST_P(RectangleLight, FromBehindThereIsNoneAndTheSunKnowsNoRectangles) {
  EXPECT_EQ(shine(candela(rectangle.at(0.1, 0.1, -0.01))), 0);
  lw_light sun{};
  sun.type = LW_LIGHT_DIRECTIONAL;
  for (size_t k = 0; k < 3; ++k) sun.direction[k] = float(-rectangle.normal[k]), sun.intensity_rgb[k] = 3;
  EXPECT_NEAR(shine(sun), 3, 1e-5);
  EXPECT_NEAR(meanOfQuarters(), 3, 1e-5);
}

TEST_P(RectangleLight, StaysFiniteInThePlaneAndAtTheMiddle) {
  for (const double u : {0.0, 1e-9, 0.2, 0.5, 0.7})
    for (const double h : {0.0, 1e-30, 1e-12, 1e-6}) {
      lw_light light = candela(rectangle.at(u, 0, h));
      std::fill_n(light.intensity_rgb, 3, 1e30f);
      shine(light);
      for (const float value : irradiance) ASSERT_TRUE(std::isfinite(value) && value >= 0) << u << " " << h;
    }
}

}  // namespace
}  // namespace lightwell::test
