// Light of emitting triangles in closed form, how they are sampled, and how light changes with the normal.
#include <gtest/gtest.h>

#include "precompute/core/random.h"
#include "precompute/transport/lightmap/plain_emitters.h"
#include "precompute/transport/lightmap/tilt.h"
#include "tests/support/scenes.h"

namespace lightwell::transport {
namespace {

/// Emits downward: a square of side 2 `half` at height `height`.
scene::Scene lampAbove(float height, float half) {
  test::SceneBuilder builder;
  builder.quad({-half, height, -half}, {2 * half, 0, 0}, {0, 0, 2 * half}, builder.material(test::diffuse(0.5f, 1.0f)));
  return builder.take();
}

float irradiance(const PlainEmitters& emitters, const Vec3& position, const Vec3& normal) {
  float sum = 0;
  for (uint32_t i = 0; i < emitters.count(); ++i) sum += emitters.irradiance(i, position, normal);
  return sum;
}

TEST(PlainEmitters, FacingSquaresHaveTheKnownFormFactor) {
  // Point under the centre of a square of side 2 at distance 1: π F with F = 4 / π × (1 / √2) × atan(1 / √2) × 2 / 2.
  const auto scene = lampAbove(1, 1);
  const PlainEmitters emitters(scene);
  const double expected = 4 / std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0));
  EXPECT_NEAR(irradiance(emitters, {0, 0, 0}, {0, 1, 0}), expected, 1e-5);
  EXPECT_EQ(irradiance(emitters, {0, 2, 0}, {0, -1, 0}), 0.0f) << "its back does not shine";
  EXPECT_EQ(irradiance(emitters, {0.2f, 1, 0.1f}, {0, -1, 0}), 0.0f) << "nor does it on itself";
  EXPECT_NEAR(irradiance(emitters, {0, 0.9999f, 0}, {0, 1, 0}), kPi, 1e-3) << "touching, it is all there is";
  EXPECT_NEAR(irradiance(emitters, {0, -1000, 0}, {0, 1, 0}) / (4 / (1001.0 * 1001.0)), 1, 1e-5) << "far away, a point";
}

TEST(PlainEmitters, SamplesGiveTheClosedForm) {
  const Sampler places(3, 0);
  for (uint32_t k = 0; k < 200; ++k) {
    const float height = std::exp(-6 * places.get1D(k, 0)) * 3;
    const auto scene = lampAbove(height, 0.5f);
    const PlainEmitters emitters(scene);
    const Vec2 at = places.get2D(k, 1);
    const Vec3 position(3 * at.x - 1.5f, 0, 3 * at.y - 1.5f), normal = (Vec3(0, 1, 0) + Vec3(places.get1D(k, 2) - 0.5f, 0, places.get1D(k, 3) - 0.5f) * 1.5f).normalized();
    for (uint32_t e = 0; e < emitters.count(); ++e) {
      const Sampler sampler(1, k * 2 + e);
      double sum = 0;
      constexpr uint32_t kSamples = 4096;
      for (uint32_t i = 0; i < kSamples; ++i) {
        const auto sample = emitters.sample(e, position, normal, sampler.get2D(i, 0));
        ASSERT_TRUE(std::isfinite(sample.weight) && sample.weight >= 0);
        sum += sample.weight;
      }
      const float exact = emitters.irradiance(e, position, normal);
      EXPECT_NEAR(sum / kSamples, exact, 0.01 * exact + 1e-4) << height << ' ' << position.x << ' ' << position.z;
    }
  }
}

TEST(PlainEmitters, AreFewAndPlain) {
  test::SceneBuilder builder;
  const uint32_t lamp = builder.material(test::diffuse(0.5f, 1.0f));
  for (int i = 0; i < 9; ++i) builder.quad({float(i), 0, 0}, {0.5f, 0, 0}, {0, 0.5f, 0}, lamp);
  EXPECT_TRUE(PlainEmitters(builder.take()).empty()) << "18 triangles are sampled instead";
}

TEST(TiltKernel, IsExactForLightHighAboveTheSurface) {
  const TiltKernel kernel;
  const Vec3 normal(0, 1, 0);
  const Vec3 to_light = Vec3(0.3f, 1, -0.2f).normalized();
  for (const Vec3& tilted : {Vec3(0, 1, 0), Vec3(0.5f, 1, 0).normalized(), Vec3(-0.4f, 1, 0.4f).normalized()}) {
    const float factor = 1 + kernel.gradient(normal, to_light).dot(tilted - normal);
    EXPECT_NEAR(factor * normal.dot(to_light), tilted.dot(to_light), 0.01f);
  }
  EXPECT_EQ(kernel.gradient(normal, {0, -1, 0}), Vec3(0.0f)) << "from below";
  EXPECT_TRUE(std::isfinite(kernel.gradient(normal, {1, 1e-9f, 0}).x)) << "grazing";
}

TEST(TiltKernel, HasTheEvenSkyRight) {
  // Under an even hemisphere a tilted surface has (1 + cos θ) / 2 of the light.
  const TiltKernel kernel;
  const Vec3 normal(0, 1, 0);
  const Sampler sampler(1, 1);
  Vec3d gradient(0.0);
  constexpr uint32_t kSamples = 1 << 14;
  for (uint32_t i = 0; i < kSamples; ++i) {
    const Vec3 local = sampleCosineHemisphere(sampler.get2D(i, 0));
    gradient += Vec3d(kernel.gradient(normal, Vec3(local.x, local.z, local.y)));
  }
  gradient /= double(kSamples);
  for (const double degrees : {15.0, 30.0, 45.0}) {
    const double angle = degrees * double(kPi) / 180, expected = (1 + std::cos(angle)) / 2;
    EXPECT_NEAR(1 + gradient.dot(Vec3d(std::sin(angle), std::cos(angle) - 1, 0)), expected, 0.02) << degrees;
  }
}

}  // namespace
}  // namespace lightwell::transport
