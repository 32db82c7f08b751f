// Light maps of static lights: closed forms, path tracing, stages.
#include <gtest/gtest.h>

#include "precompute/transport/fixed_point.h"
#include "precompute/transport/lightmap/share.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/reference/reference.h"
#include "tests/environment/skies.h"
#include "tests/transport/baked_lightmap.h"

namespace lightwell::transport {
namespace {

TEST(Lightmap, AFurnaceHasTheGeometricSeries) {
  for (const float albedo : {0.5f, 0.9f, 0.99f}) {
    const Prepared p(test::closedBox({1, 1, 1}, test::diffuse(albedo, 1.0f)), 32);
    const Lightmap map = bake(p, {});
    for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot) {
      // Half of it straight from the walls, which all emit.
      EXPECT_NEAR(map.direct_rgb[slot].x / kPi, 1.0f, 0.05f);
      EXPECT_NEAR((map.direct_rgb[slot].x + map.indirect_rgb[slot].x) * (1 - albedo) / kPi, 1.0f, 0.03f) << albedo;
    }
  }
}

/// Luminance received by all surfaces: direct, indirect.
std::pair<double, double> flux(const Prepared& p, const Lightmap& map) {
  double direct = 0, indirect = 0;
  for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot) {
    direct += luminance(map.direct_rgb[slot]) * double(p.atlas.slots[slot].area);
    indirect += luminance(map.indirect_rgb[slot]) * double(p.atlas.slots[slot].area);
  }
  return {direct, indirect};
}

TEST(Lightmap, AClosedRoomKeepsTheEnergyOfALamp) {
  for (const float albedo : {0.3f, 0.8f}) {
    scene::Scene scene = test::closedBox({1, 1.5f, 2}, test::diffuse(albedo));
    scene.lights.push_back(test::pointLight({0.3f, 0.4f, -0.7f}, 3.0f));
    const Prepared p(std::move(scene), 48);
    const Lightmap map = bake(p, {});
    const auto [direct, indirect] = flux(p, map);
    EXPECT_NEAR(direct / (4 * kPi * 3.0), 1.0, 0.002);
    EXPECT_NEAR(indirect / (4 * kPi * 3.0 * albedo / (1 - albedo)), 1.0, 0.005) << albedo;
  }
}

TEST(Lightmap, ALampThatAllButTouchesAWallLosesNothing) {
  // Half of its light falls on a spot as small as the gap, which points of the texel would miss.
  for (const float gap : {1e-2f, 1e-4f, 1e-5f})
    for (const Vec3& position : {Vec3(0.3f, 0.4f, 2 - gap), Vec3(1 - gap, 1.5f - gap, 2 - gap)}) {
      scene::Scene scene = test::closedBox({1, 1.5f, 2}, test::diffuse(0.5f));
      scene.lights.push_back(test::pointLight(position, 3.0f));
      const Prepared p(std::move(scene), 48);
      const Lightmap map = bake(p, {});
      const auto [direct, indirect] = flux(p, map);
      EXPECT_NEAR(direct / (4 * kPi * 3.0), 1.0, 0.005) << gap;
      EXPECT_NEAR(indirect / (4 * kPi * 3.0), 1.0, 0.06) << gap << " " << position;
    }
}

TEST(Lightmap, AnEmitterThatIsHiddenTakesNothingFromOneThatIsNot) {
  // Two closed rooms, each with a panel on its ceiling; one is a million times as bright. Rays that follow what panels would give all end on the wall between.
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.5f)), bright = builder.material(test::diffuse(0.5f, 1e3f)), dim = builder.material(test::diffuse(0.5f, 1e-3f));
  builder.room({-4, 0, -2}, {-0.1f, 3, 2}, wall).room({0.1f, 0, -2}, {4, 3, 2}, wall);
  builder.quad({-2.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, bright).quad({1.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, dim);
  const Prepared p(builder.take(), 64);
  const Lightmap map = bake(p, {});
  double direct[2] = {}, total[2] = {};
  for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot) {
    const bool right = p.atlas.slots[slot].position.x > 0;
    direct[right] += luminance(map.direct_rgb[slot]) * double(p.atlas.slots[slot].area);
    total[right] += luminance(map.direct_rgb[slot] + map.indirect_rgb[slot]) * double(p.atlas.slots[slot].area);
  }
  EXPECT_NEAR(direct[0], kPi * 1e3, kPi * 20) << "all that the panel sends";
  EXPECT_NEAR(direct[1], kPi * 1e-3, kPi * 1e-4) << "a ratio of few rays is biased, but by little";
  EXPECT_NEAR(total[0] / total[1], 1e6, 1e5);
}

TEST(Lightmap, ASkyThatNothingSeesAddsNothing) {
  // Plain emitters have their exact light, and the sky its own rays: what these meet indoors must not count again.
  test::SceneBuilder builder;
  builder.room({-2, 0, -2}, {2, 3, 2}, builder.material(test::diffuse(0.5f)));
  builder.quad({-0.5f, 2.9f, -0.5f}, {1, 0, 0}, {0, 0, 1}, builder.material(test::diffuse(0.5f, 10)));
  const Prepared p(builder.take(), 32);
  Diagnostics diagnostics;
  EnvironmentMap white = makeSky(16, 8, [](const Vec3&) { return Rgb(1.0f); }, {});
  const SkyLight sky(makeSkyGrid(white, 16, diagnostics, nullptr));
  const Lightmap without = bake(p, {}), with = bake(p, {}, 200, 2, nullptr, &sky);
  double direct[2] = {}, indirect[2] = {};
  for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot)
    for (const int k : {0, 1}) {
      direct[k] += luminance((k ? with : without).direct_rgb[slot]) * double(p.atlas.slots[slot].area);
      indirect[k] += luminance((k ? with : without).indirect_rgb[slot]) * double(p.atlas.slots[slot].area);
    }
  EXPECT_NEAR(direct[1] / direct[0], 1, 0.01);
  EXPECT_NEAR(indirect[1] / indirect[0], 1, 0.02);
}

TEST(FixedPoint, PartsThatAreNotCoupledAreSolvedAlikeHoweverMuchBrighterOneIs) {
  // x = 0.95 P x + b in two rooms with a cyclic permutation each, b 1e9 times as large in one.
  constexpr Eigen::Index kRoom = 12;
  Eigen::VectorXd b = Eigen::VectorXd::Zero(2 * kRoom);
  b[0] = 1e9, b[kRoom] = 1;
  const auto sweep = [&](const Eigen::VectorXd& x) {
    Eigen::VectorXd next = b;
    for (Eigen::Index room = 0; room < 2; ++room)
      for (Eigen::Index i = 0; i < kRoom; ++i) next[room * kRoom + (i + 1) % kRoom] += (room ? 0.95 : 0.6) * x[room * kRoom + i];
    return next;
  };
  const FixedPoint fixed = solveFixedPoint(2 * kRoom, sweep, 1e-6, 500);
  EXPECT_LE(fixed.residual, 1e-6);
  EXPECT_NEAR(fixed.x[kRoom], 1 / (1 - std::pow(0.95, double(kRoom))), 1e-4);
  EXPECT_NEAR(fixed.x[0] / 1e9, 1 / (1 - std::pow(0.6, double(kRoom))), 1e-4);
  EXPECT_EQ(solveFixedPoint(3, [](const Eigen::VectorXd& x) -> Eigen::VectorXd { return Eigen::VectorXd::Zero(x.size()); }, 1e-6, 500).sweeps, 1u) << "darkness";
}

TEST(Lightmap, IsWhatPathTracingGives) {
  const Prepared p(roomWithBox(0.6f), 96);
  const Lightmap map = bake(p, {});
  std::vector<std::vector<Rgb>> references;
  for (const uint64_t seed : {11u, 12u, 13u})
    references.push_back(referenceIrradiance(p.scene, p.atlas, *p.tracer, p.scene.lights, Component::indirect, {.samples = 256, .seed = seed}).irradiance_rgb);
  const auto indirect = compareWithReferences(references, map.indirect_rgb);
  EXPECT_LT(indirect.relrmse, 0.03);
  EXPECT_LT(indirect.texrel, 0.05);
  EXPECT_LT(std::abs(indirect.bias), 0.006);
  references.clear();
  for (const uint64_t seed : {11u, 12u, 13u})
    references.push_back(referenceIrradiance(p.scene, p.atlas, *p.tracer, p.scene.lights, Component::direct, {.samples = 1024, .seed = seed}).irradiance_rgb);
  const auto direct = compareWithReferences(references, map.direct_rgb);
  EXPECT_LT(direct.relrmse, 0.01);
  EXPECT_LT(std::abs(direct.bias), 0.003);
}

TEST(Lightmap, SharingTakesNoiseAwayAndLeavesEdges) {
  // A floor of one chart whose left half is lit four times as brightly, without any transition; noise of 20 %.
  test::SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 4}, {4, 0, 0}, builder.material(test::diffuse(0.5f)));
  const Prepared p(builder.take(), 64);
  const auto truth = [&](uint32_t slot) { return p.atlas.slots[slot].position.x < 2 ? 4.0f : 1.0f + 0.1f * p.atlas.slots[slot].position.z; };
  GatheredPair noisy;
  for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot) {
    const Sampler sampler(1, slot);
    noisy.a_rgb.emplace_back(truth(slot) * (1 + 0.7f * (sampler.get1D(0, 0) - 0.5f)));
    noisy.b_rgb.emplace_back(truth(slot) * (1 + 0.7f * (sampler.get1D(0, 1) - 0.5f)));
  }
  const std::vector<float> exposed(p.atlas.slots.size(), 1.0f);
  const auto shared = shareIrradiance(p.atlas, exposed, noisy, 2, nullptr).irradiance_rgb;
  double before = 0, after = 0, edge = 0;
  int edges = 0;
  for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot) {
    const double is = truth(slot), was = (noisy.a_rgb[slot].x + noisy.b_rgb[slot].x) / 2, now = shared[slot].x;
    before += std::pow(was / is - 1, 2), after += std::pow(now / is - 1, 2);
    if (std::abs(p.atlas.slots[slot].position.x - 2) < 0.1f) edge += std::pow(now / is - 1, 2), ++edges;
  }
  EXPECT_LT(after, 0.25 * before);
  EXPECT_LT(std::sqrt(edge / edges), 0.4);
}

TEST(Lightmap, StagesDependNeitherOnThreadsNorOnHowTheyAreCut) {
  const Prepared p(roomWithBox(0.5f), 32);
  LightmapSettings settings;
  settings.gather_rays = 16, settings.cache_rays = 32;
  const Lightmap one = bake(p, settings, 1000, 1), many = bake(p, settings, 17, 3);
  EXPECT_EQ(one.direct_rgb, many.direct_rgb);
  EXPECT_EQ(one.indirect_rgb, many.indirect_rgb);
}

TEST(Lightmap, DamagedResultsAreRefused) {
  const Prepared p(roomWithBox(0.5f), 24);
  const Bytes patches = makeLightmapPatchBytes(p.scene, p.atlas, *p.tracer, {}, 1, nullptr);
  const LightmapBaker baker(p.scene, p.atlas, *p.tracer, p.scene.lights, nullptr, {}, patches);
  const CancelFlag cancel;
  const Bytes part = baker.firstLight(0, 3, cancel);
  const std::vector<ByteView> short_of{part};
  EXPECT_THROW((void)baker.directLight(0, 3, short_of, cancel), std::runtime_error);
  EXPECT_THROW((void)baker.gather(0, 3, part, cancel), std::runtime_error);
  EXPECT_THROW((void)LightmapBaker(p.scene, p.atlas, *p.tracer, p.scene.lights, nullptr, {}, part), std::runtime_error);
}

}  // namespace
}  // namespace lightwell::transport
