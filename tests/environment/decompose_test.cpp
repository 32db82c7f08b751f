#include "precompute/transport/environment/decompose.h"

#include <gtest/gtest.h>

#include <cstring>

#include "precompute/core/random.h"
#include "precompute/transport/environment/bake_environment.h"
#include "precompute/transport/environment/seeding.h"
#include "precompute/transport/environment/spherical_voronoi.h"
#include "tests/environment/skies.h"

namespace lightwell::transport {
namespace {

constexpr double kPiD = std::numbers::pi;

SkyGrid gridOf(EnvironmentMap map, int max_width = 2048) {
  Diagnostics diagnostics;
  return makeSkyGrid(map, max_width, diagnostics, nullptr);
}
Decomposition decomposeSky(const SkyGrid& grid, uint32_t samples, bool fast = false, int threads = 2) {
  DecompositionSettings settings;
  settings.samples = samples;
  settings.fast = fast;
  settings.threads = threads;
  return decompose(grid, settings, nullptr);
}
template <class T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}
bool sameCells(const EnvironmentCells& a, const EnvironmentCells& b) {
  return a.sun_count == b.sun_count && sameBytes(a.direction, b.direction) && sameBytes(a.flux_rgb, b.flux_rgb) &&
         sameBytes(a.solid_angle_sr, b.solid_angle_sr) && sameBytes(a.spread, b.spread) && sameBytes(a.covariance, b.covariance);
}
void expectFinite(const EnvironmentCells& cells) {
  for (uint32_t i = 0; i < cells.count(); ++i) {
    EXPECT_TRUE(isFinite(cells.direction[i]) && isFinite(cells.flux_rgb[i]));
    EXPECT_NEAR(cells.direction[i].length(), 1, 1e-5);
    EXPECT_GE(cells.spread[i], 0);
    EXPECT_LE(cells.spread[i], 1);
    EXPECT_GT(cells.solid_angle_sr[i], 0);
    for (float v : cells.covariance[i]) EXPECT_TRUE(std::isfinite(v));
  }
}

class CellSums : public ::testing::TestWithParam<std::tuple<uint32_t, bool>> {};

TEST_P(CellSums, EqualTheMapsIntegralAndTheSphere) {
  const auto [samples, fast] = GetParam();
  const SkyGrid grid = gridOf(makeSky(512, 256, outdoorRadiance));
  const EnvironmentCells cells = decomposeSky(grid, samples, fast).cells;
  EXPECT_EQ(cells.count(), samples);
  double solid_angle = 0;
  std::array<double, 3> from_cells{}, from_map{};
  for (uint32_t i = 0; i < cells.count(); ++i) {
    solid_angle += cells.solid_angle_sr[i];
    for (size_t c = 0; c < 3; ++c) from_cells[c] += cells.flux_rgb[i][int(c)];
  }
  for (int y = 0; y < 256; ++y)  // independent of the grid: exact solid angles from the antiderivative
    for (int x = 0; x < 512; ++x) {
      const double texel = 2 * kPiD / 512 * (std::cos(y * kPiD / 256) - std::cos((y + 1) * kPiD / 256));
      const Rgb radiance = outdoorRadiance(directionOf((y + 0.5) / 256 * kPiD, ((x + 0.5) / 512 - 0.5) * 2 * kPiD));
      for (size_t c = 0; c < 3; ++c) from_map[c] += texel * double(radiance[int(c)]);
    }
  EXPECT_NEAR(solid_angle / (4 * kPiD), 1, 1e-6);
  for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(from_cells[c] / from_map[c], 1, 1e-6);
  expectFinite(cells);
}
INSTANTIATE_TEST_SUITE_P(SampleCounts, CellSums, ::testing::Combine(::testing::Values(8, 128, 1024), ::testing::Bool()));

TEST(Decompose, SumsSurviveAWorkingResolutionThatDoesNotDivideTheMap) {
  const SkyGrid full = gridOf(makeSky(301, 150, outdoorRadiance)), reduced = gridOf(makeSky(301, 150, outdoorRadiance), 64);
  EXPECT_LE(reduced.width, 64);
  double full_flux = 0, reduced_flux = 0, solid_angle = 0;
  for (const auto& flux : full.flux_rgb) full_flux += flux[1];
  for (const auto& flux : reduced.flux_rgb) reduced_flux += flux[1];
  for (double s : reduced.solid_angle_sr) solid_angle += s;
  EXPECT_NEAR(reduced_flux / full_flux, 1, 1e-12);
  EXPECT_NEAR(solid_angle, 4 * kPiD, 1e-9);
}

TEST(Decompose, SunIsACellOfItsOwnWithItsPowerDirectionAndSize) {
  const Vec3 sun = Vec3(0.5f, 0.6f, 0.62f).normalized();
  const float radius = 0.012f;
  const auto radiance = [&](const Vec3& d) { return Rgb(1, 1, 1) + Rgb(1e6f, 1e6f, 1e6f) * inCap(d, sun, radius); };
  const EnvironmentCells cells = decomposeSky(gridOf(makeSky(2048, 1024, radiance)), 32).cells;
  ASSERT_EQ(cells.sun_count, 1u);
  EXPECT_NEAR((cells.direction[0] - sun).length(), 0, 1e-3);
  const double expected = kPiD * radius * radius;
  EXPECT_NEAR(cells.solid_angle_sr[0] / expected, 1, 0.06);  // a disc of 50 texels has a ragged rim
  EXPECT_NEAR(cells.flux_rgb[0].x / (expected * 1e6), 1, 0.06);
  EXPECT_NEAR(cells.covariance[0][0] / (radius * radius / 4), 1, 0.1);
}

TEST(Decompose, SingleTexelSunIsExactInPowerAndDirection) {
  for (const int row : {0, 40, 127}) {  // at a pole, in between, at the other pole
    std::vector<Rgb> pixels(256 * 128, Rgb(0.5f));
    pixels[size_t(row) * 256] = Rgb(1e6f, 2e6f, 3e6f);  // on the seam
    EnvironmentMap map(memoryRowSource(256, 128, pixels), "sun");
    const EnvironmentCells cells = decomposeSky(gridOf(std::move(map)), 16).cells;
    ASSERT_EQ(cells.sun_count, 1u) << row;
    const double texel = 2 * kPiD / 256 * (std::cos(row * kPiD / 128) - std::cos((row + 1) * kPiD / 128));
    EXPECT_NEAR(cells.flux_rgb[0].z / (3e6 * texel), 1, 1e-6);
    EXPECT_NEAR((cells.direction[0] - directionOf((row + 0.5) / 128 * kPiD, (0.5 / 256 - 0.5) * 2 * kPiD)).length(), 0, 1e-6);
  }
}

TEST(Decompose, WideLampsAndPlainSkiesHaveNoSun) {
  const Vec3 lamp = Vec3(1, 1, 0).normalized();
  const auto lit = [&](const Vec3& d) { return Rgb(1, 1, 1) + Rgb(1e4f, 1e4f, 1e4f) * inCap(d, lamp, 0.2f); };
  EXPECT_EQ(decomposeSky(gridOf(makeSky(256, 128, lit)), 16).cells.sun_count, 0u);
  EXPECT_EQ(decomposeSky(gridOf(makeSky(256, 128, [](const Vec3&) { return Rgb(3, 2, 1); })), 16).cells.sun_count, 0u);
}

TEST(Decompose, SameCellsForAnyNumberOfThreads) {
  const SkyGrid grid = gridOf(makeSky(512, 256, outdoorRadiance));
  const EnvironmentCells one = decomposeSky(grid, 100, false, 1).cells;
  EXPECT_TRUE(sameCells(one, decomposeSky(grid, 100, false, 2).cells));
  EXPECT_TRUE(sameCells(one, decomposeSky(grid, 100, false, 5).cells));
}

TEST(Decompose, BlackMapIsCutEvenly) {
  const EnvironmentCells cells = decomposeSky(gridOf(makeSky(128, 64, [](const Vec3&) { return Rgb(0, 0, 0); })), 64).cells;
  expectFinite(cells);
  EXPECT_EQ(cells.count(), 64u);
  for (uint32_t i = 0; i < cells.count(); ++i) {
    EXPECT_EQ(cells.flux_rgb[i], Rgb(0, 0, 0));
    EXPECT_NEAR(cells.solid_angle_sr[i] * 64 / (4 * kPiD), 1, 0.6);
  }
}

TEST(Decompose, OneBrightTexelInTheDark) {
  for (const bool fast : {false, true}) {
    std::vector<Rgb> pixels(64 * 32, Rgb(0, 0, 0));
    pixels[10 * 64 + 5] = Rgb(1e9f, 1e9f, 1e9f);
    EnvironmentMap map(memoryRowSource(64, 32, pixels), "texel");
    const EnvironmentCells cells = decomposeSky(gridOf(std::move(map)), 128, fast).cells;
    expectFinite(cells);
    EXPECT_NEAR((cells.direction[0] - directionOf(10.5 / 32 * kPiD, (5.5 / 64 - 0.5) * 2 * kPiD)).length(), 0, 1e-6);
  }
}

TEST(Decompose, MillionToOneContrast) {
  const auto radiance = [](const Vec3& d) { return d.x > 0 ? Rgb(1e3f, 1e3f, 1e3f) : Rgb(1e-3f, 1e-3f, 1e-3f); };
  const EnvironmentCells cells = decomposeSky(gridOf(makeSky(256, 128, radiance)), 64).cells;
  expectFinite(cells);
  uint32_t dark = 0;
  for (const Rgb& flux : cells.flux_rgb) dark += flux.x < 0.1f;
  EXPECT_GE(dark, 1u);  // the floor of the importance keeps some cells for the dark side
  EXPECT_LE(dark, 16u);
}

TEST(Decompose, SmallMapsAndManySamples) {
  const EnvironmentCells cells = decomposeSky(gridOf(makeSky(4, 2, outdoorRadiance)), 128).cells;
  expectFinite(cells);
  EXPECT_LE(cells.count(), 8u);
  EXPECT_EQ(decomposeSky(gridOf(makeSky(1, 1, outdoorRadiance)), 8).cells.count(), 1u);
}

TEST(Decompose, RadianceDensityAsThePaperAsks) {
  // One half sphere 9 times as bright: with exponent e it has 9^e times the cells.
  const SkyGrid grid = gridOf(makeSky(512, 256, [](const Vec3& d) { return d.x > 0 ? Rgb(9, 9, 9) : Rgb(1, 1, 1); }));
  for (const auto& [exponent, ratio] : {std::pair{0.5f, 3.0}, std::pair{1.0f, 9.0}}) {
    DecompositionSettings settings;
    settings.samples = 512;
    settings.density_exponent = exponent;
    const EnvironmentCells cells = decompose(grid, settings, nullptr).cells;
    double bright = 0, dark = 0;
    for (const Vec3& d : cells.direction) (d.x > 0 ? bright : dark) += 1;
    EXPECT_NEAR(bright / dark / ratio, 1, 0.25) << exponent;
  }
}

TEST(Decompose, RefusesSettingsThatCannotBeMeant) {
  const SkyGrid grid = gridOf(makeSky(16, 8, outdoorRadiance));
  EXPECT_THROW(decomposeSky(grid, 0), UsageError);
  DecompositionSettings settings;
  settings.density_exponent = std::nanf("");
  EXPECT_THROW(decompose(grid, settings, nullptr), UsageError);
  CancelFlag cancel;
  cancel.cancel();
  EXPECT_THROW(decompose(grid, DecompositionSettings{}, &cancel), Cancelled);
}

TEST(SphericalVoronoi, IsTheNearestSeedEverywhere) {
  const SkyGrid grid = gridOf(makeSky(100, 50, outdoorRadiance));
  for (const uint32_t count : {1u, 2u, 7u, 300u}) {
    std::vector<Vec3> seed;
    const Sampler sampler(3, count);
    for (uint32_t i = 0; i < count; ++i) seed.push_back(uniformDirection(sampler.get2D(i, 0)));
    for (uint32_t i = 0; i < count / 2; ++i) seed[i] = (seed[i] + Vec3(30, 3, 4)).normalized();  // a dense cluster
    const std::vector<uint32_t> label = SphericalVoronoi(grid).assign(seed, 2);
    for (size_t t = 0; t < grid.size(); ++t) {
      float nearest = 9;
      for (const Vec3& s : seed) nearest = std::min(nearest, (grid.direction[t] - s).length2());
      ASSERT_EQ((grid.direction[t] - seed[label[t]]).length2(), nearest) << t;
    }
  }
}

TEST(Seeding, BlueNoiseKeepsItsDistance) {
  const SkyGrid grid = gridOf(makeSky(512, 256, [](const Vec3&) { return Rgb(1, 1, 1); }));
  const std::vector<Vec3> seeds = blueNoiseSeeds(grid, seedImportance(grid, 1, 200), 200, 5);
  ASSERT_EQ(seeds.size(), 200u);
  float closest = 9;
  for (size_t i = 0; i < seeds.size(); ++i)
    for (size_t j = 0; j < i; ++j) closest = std::min(closest, (seeds[i] - seeds[j]).length());
  const double best = std::sqrt(2 / std::sqrt(3.0) * 4 * kPiD / 200);  // hexagonal packing
  EXPECT_GT(closest, 0.5 * best);
}

}  // namespace
}  // namespace lightwell::transport
