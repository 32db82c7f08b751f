// The numeric encodings: exact where they are exact, and within their documented rounding elsewhere.
#include <gtest/gtest.h>

#include <random>

#include "format/decode/pixel.h"

namespace lightwell::format {
namespace {

TEST(Rgb9e5, KnownValues) {
  EXPECT_EQ(packRgb9e5({0, 0, 0}), 0u);
  EXPECT_EQ(packRgb9e5({1, 1, 1}), 16u << 27 | 256u << 18 | 256u << 9 | 256u);
  EXPECT_EQ(packRgb9e5({kRgb9e5Max, 0, 0}), 31u << 27 | 511u);
  EXPECT_EQ(packRgb9e5({1e30f, -5, NAN}), 31u << 27 | 511u);
  EXPECT_EQ(packRgb9e5({INFINITY, 0, 0}), 31u << 27 | 511u);
  static_assert(unpackRgb9e5(16u << 27 | 256u).x == 1.0f);
  EXPECT_EQ(unpackRgb9e5(packRgb9e5({kRgb9e5Max, 1024, 0})).y, 1024.0f);
}

TEST(Rgb9e5, EveryCanonicalValueSurvives) {
  // Canonical: the exponent is the least that holds the largest mantissa, which then has its top bit set (or the exponent is zero).
  for (uint32_t exponent = 0; exponent < 32; ++exponent)
    for (uint32_t largest = exponent == 0 ? 0 : 256; largest < 512; ++largest) {
      const uint32_t packed = exponent << 27 | largest / 7 << 18 | largest << 9 | largest / 3;
      EXPECT_EQ(packRgb9e5(unpackRgb9e5(packed)), packed) << std::hex << packed;
    }
}

TEST(Rgb9e5, ErrorIsAtMostHalfAStep) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> exponent(-18, 15.9f), fraction(0, 1);
  for (int i = 0; i < 200000; ++i) {
    const float largest = std::exp2(exponent(random));
    const Float3 value{largest, largest * fraction(random), largest * fraction(random)};
    const uint32_t packed = packRgb9e5(value);
    const Float3 back = unpackRgb9e5(packed);
    const float half_step = std::exp2(float(packed >> 27) - 25) * 1.0001f;
    // No finer exponent would hold the largest component, up to its rounding.
    EXPECT_TRUE(packed >> 27 == 0 || largest >= 511.5f / 512 * std::exp2(float(packed >> 27) - 16)) << largest;
    EXPECT_LE(std::abs(back.x - value.x), half_step) << largest;
    EXPECT_LE(std::abs(back.y - value.y), half_step);
    EXPECT_LE(std::abs(back.z - value.z), half_step);
  }
}

TEST(Half, EveryValueSurvivesAndOrderIsKept) {
  for (uint32_t h = 0; h < 0x10000; ++h) {
    const float value = unpackHalf(uint16_t(h));
    EXPECT_TRUE(packHalf(value) == h || (std::isnan(value) && std::isnan(unpackHalf(packHalf(value))))) << h;
  }
  static_assert(unpackHalf(0x3c00) == 1.0f && unpackHalf(0x0001) == 0x1p-24f && packHalf(65504.0f) == 0x7bff);
}

TEST(Half, RoundsToNearestTiesToEven) {
  EXPECT_EQ(packHalf(1 + 0x1p-11f), 0x3c00);              // a tie: down to even
  EXPECT_EQ(packHalf(1 + 3 * 0x1p-11f), 0x3c02);          // a tie: up to even
  EXPECT_EQ(packHalf(std::nextafter(1 + 0x1p-11f, 2.f)), 0x3c01);
  EXPECT_EQ(packHalf(0x1p-25f), 0x0000);                  // half the least: ties to zero
  EXPECT_EQ(packHalf(std::nextafter(0x1p-25f, 1.f)), 0x0001);
  EXPECT_EQ(packHalf(65519.99f), 0x7bff);
  EXPECT_EQ(packHalf(65520.0f), 0x7c00);
  EXPECT_EQ(packHalf(-INFINITY), 0xfc00);
  // Between two neighbours the nearer one is taken, for all neighbours.
  for (uint32_t h = 0; h < 0x7bff; ++h) {
    const float low = unpackHalf(uint16_t(h)), high = unpackHalf(uint16_t(h + 1)), middle = (low + high) / 2;
    EXPECT_EQ(packHalf(std::nextafter(middle, 0.0f)), h);
    EXPECT_EQ(packHalf(std::nextafter(middle, 1e9f)), h + 1);
    EXPECT_EQ(packHalf(middle), h + (h & 1));
  }
}

TEST(Oct, UnitAndWithinTheStatedAngle) {
  std::mt19937 random(2);
  std::normal_distribution<float> normal;
  double worst = 0;
  for (int i = 0; i < 200000; ++i) {
    Float3 n{normal(random), normal(random), normal(random)};
    if (i % 5 == 0) n.z = 0;
    if (i % 7 == 0) n.x *= 1e-6f;
    const double length = std::sqrt(double(n.x) * n.x + double(n.y) * n.y + double(n.z) * n.z);
    const Float3 back = unpackOct(packOct(n));
    const double cx = (double(n.y) * back.z - double(n.z) * back.y) / length, cy = (double(n.z) * back.x - double(n.x) * back.z) / length,
                 cz = (double(n.x) * back.y - double(n.y) * back.x) / length;
    worst = std::max(worst, std::sqrt(cx * cx + cy * cy + cz * cz));
    EXPECT_NEAR(double(back.x) * back.x + double(back.y) * back.y + double(back.z) * back.z, 1, 1e-6);
    EXPECT_GT(double(n.x) * back.x + double(n.y) * back.y + double(n.z) * back.z, 0);
  }
  EXPECT_LT(worst, 1e-4);
  EXPECT_GT(worst, 1e-6);
}

TEST(Oct, AxesAreExactAndOddInputsAreSafe) {
  const Float3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const Float3& n : axes) {
    const Float3 back = unpackOct(packOct(n));
    EXPECT_EQ(back.x, n.x);
    EXPECT_EQ(back.y, n.y);
    EXPECT_EQ(back.z, n.z);
  }
  EXPECT_EQ(unpackOct(packOct({0, 0, 0})).z, 1.0f);
  EXPECT_EQ(unpackOct(packOct({NAN, 0, 1})).z, 1.0f);
  for (const int x : {-32768, -32767, 0, 32767})
    for (const int y : {-32768, -32767, 0, 32767}) {
      const Float3 v = unpackOct({int16_t(x), int16_t(y)});
      EXPECT_NEAR(v.x * v.x + v.y * v.y + v.z * v.z, 1, 1e-6);
    }
}

TEST(Srgb, EveryByteSurvivesAndKnownValues) {
  for (int v = 0; v < 256; ++v) EXPECT_EQ(encodeSrgb(decodeSrgb(uint8_t(v))), v);
  EXPECT_EQ(decodeSrgb(0), 0.0f);
  EXPECT_EQ(decodeSrgb(255), 1.0f);
  EXPECT_NEAR(decodeSrgb(188), 0.5029, 1e-4);
  EXPECT_EQ(encodeSrgb(0.5f), 188);
  EXPECT_EQ(encodeSrgb(-1), 0);
  EXPECT_EQ(encodeSrgb(7), 255);
  EXPECT_EQ(encodeSrgb(NAN), 0);
}

}  // namespace
}  // namespace lightwell::format
