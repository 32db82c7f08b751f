// Radiosity: patches, form factors, compressed links and their solution, against closed forms and path tracing.
#include <gtest/gtest.h>

#include "precompute/core/parallel.h"
#include "precompute/transport/exposure.h"
#include "precompute/transport/pooled_error.h"
#include "precompute/transport/radiosity/bake_radiosity.h"
#include "precompute/transport/radiosity/solve.h"
#include "precompute/transport/reference/reference.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/stages.h"

namespace lightwell::transport {
namespace {

using Prepared = test::PreparedScene;

RadiositySettings smallSettings() {
  RadiositySettings settings;
  settings.rays = 512;
  settings.training_lights = 32;
  return settings;
}

/// All stages, cut into ranges of `grain`, on `threads` threads.
RadiosityResult bake(const Prepared& p, const RadiositySettings& settings, uint32_t grain = 64, int threads = 2) {
  const Bytes patches = makePatchBytes(p.scene, p.atlas, *p.tracer, settings, threads, nullptr);
  const RadiosityBaker baker(p.scene, p.atlas, *p.tracer, settings, patches);
  const auto stage = [&](uint32_t count, auto function) { return test::inRanges(count, grain, threads, function); };
  using test::views;
  const auto hits = stage(baker.patchCount(), [&](uint32_t a, uint32_t b) { return baker.hits(a, b); });
  const auto direct = stage(baker.trainingLightCount(), [&](uint32_t a, uint32_t b) { return baker.direct(a, b); });
  const Bytes trained = baker.train(views(hits), views(direct));
  const auto links = stage(baker.patchCount(), [&](uint32_t a, uint32_t b) { return baker.links(a, b, trained); });
  return baker.assemble(views(links), threads, nullptr);
}

std::vector<Rgb> emittedRadiosity(const Patches& patches) {
  std::vector<Rgb> emitted_rgb;
  for (const Rgb& radiance : patches.emitted_radiance_rgb) emitted_rgb.push_back(radiance * kPi);
  return emitted_rgb;
}

/// A scene as far as its form factors.
struct Factors {
  Prepared p;
  Sides sides;
  std::vector<float> exposed;
  Patches patches;
  FormFactors factors;
  Factors(scene::Scene scene, uint32_t rays, PatchOptions options = {}, int size = 48) : p(std::move(scene), size), sides(surfaceSides(p.atlas)) {
    exposed = exposedShare(p.scene, p.atlas, *p.tracer, sides, 1, 2, nullptr);
    patches = makePatches(p.scene, p.atlas, *p.tracer, sides, exposed, options);
    colorPatches(p.atlas, sides, exposed, patches);
    const GatedTracer tracer(p.scene, p.atlas, *p.tracer, nullptr, sides, patches);
    const HitCounts hits = countHits(p.scene, p.atlas, tracer, sides, patches, rays, 1, 0, patches.count());
    factors = makeFormFactors(tracer.zones(), patches, hits, rays);
  }
};

TEST(Radiosity, AClosedRoomHasTheGeometricSeriesAtEveryPatchAtAnyAlbedo) {
  for (const float albedo : {0.5f, 0.9f, 0.99f, 0.999f}) {
    const Prepared p(test::closedBox({1, 1, 1}, test::diffuse(albedo, 1.0f)), 32);
    const RadiosityResult result = bake(p, smallSettings());
    const std::vector<Rgb> dark(result.patches.count(), Rgb(0.0f));
    const auto solution = solveRadiosity(result.links, result.tree, result.patches.albedo_rgb, dark, emittedRadiosity(result.patches));
    const float exact = kPi / (1 - albedo), tolerance = albedo > 0.99f ? 0.02f : 0.005f;
    for (const Rgb& irradiance_rgb : solution.irradiance_rgb)
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(irradiance_rgb[c] / exact, 1.0f, tolerance) << "albedo " << albedo;
    EXPECT_LT(solution.sweeps, 60u) << "plain sweeps would need " << std::log(1e-7) / std::log(albedo);
  }
}

TEST(Radiosity, FormFactorsAreReciprocalAndFillTheHemisphere) {
  const Factors f(test::closedBox({2, 1, 3}, test::diffuse(0.5f)), 256);
  std::vector<std::vector<std::pair<uint32_t, float>>> rows(f.patches.count());
  for (uint32_t row = 0; row < f.factors.rows(); ++row) {
    double sum = 0;
    for (uint64_t i = f.factors.first[row]; i < f.factors.first[row + 1]; ++i) {
      sum += f.factors.value[i];
      rows[row].emplace_back(f.factors.patch[i], f.factors.value[i]);
    }
    EXPECT_NEAR(sum, 1.0, 2.0 / 256) << "patch " << row;  // a ray or two may slip through an edge
  }
  for (uint32_t row = 0; row < rows.size(); ++row)
    for (const auto& [other, value] : rows[row]) {
      const auto back = std::lower_bound(rows[other].begin(), rows[other].end(), std::pair(row, 0.0f));
      ASSERT_TRUE(back != rows[other].end() && back->first == row);
      ASSERT_NEAR(f.patches.area[row] * value, f.patches.area[other] * back->second, 0.01 * f.patches.area[row] * value + 1e-9);
    }
}

TEST(Radiosity, FacingSquaresHaveTheirAnalyticFormFactor) {
  // Unit squares at distance 1: 0.19982 (Howell, "A Catalog of Radiation Heat Transfer Configuration Factors", C-11).
  test::SceneBuilder builder;
  const uint32_t grey = builder.material(test::diffuse(0.5f));
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, grey).quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, grey);
  const Factors f(builder.take(), 1024);
  double exchange = 0, area = 0;
  for (uint32_t row = 0; row < f.patches.count(); ++row) {
    if (f.patches.normal[row].y < 0) continue;
    for (uint64_t i = f.factors.first[row]; i < f.factors.first[row + 1]; ++i) exchange += double(f.patches.area[row]) * f.factors.value[i];
    area += f.patches.area[row];
  }
  EXPECT_NEAR(exchange / area, 0.19982, 0.001);
}

/// A room with a box on its floor, whose bottom is left out.
scene::Scene roomWithBox() {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(0.6f)), box = builder.material(test::diffuse(0.4f));
  builder.room({-4, -3, -4}, {4, 3, 4}, wall);
  const Vec3 x(2, 0, 0), y(0, 2, 0), z(0, 0, 2), low(-1.3f, -3, -0.7f);
  builder.quad(low + y, z, x, box);
  builder.quad(low, z, y, box).quad(low + x, y, z, box).quad(low, y, x, box).quad(low + z, x, y, box);
  return builder.take();
}

TEST(Radiosity, WhatABoxStandsOnIsNotExposed) {
  const Prepared p(roomWithBox(), 128);
  const Sides sides = surfaceSides(p.atlas);
  const auto exposed = exposedShare(p.scene, p.atlas, *p.tracer, sides, 1, 2, nullptr);
  double floor_area = 0;
  for (uint32_t slot = 0; slot < p.atlas.slots.size(); ++slot)
    if (p.scene.mesh.triangle_object[p.atlas.patches[p.atlas.slots[slot].first_patch].triangle] == 0) floor_area += double(p.atlas.slots[slot].area) * exposed[slot];
  EXPECT_NEAR(floor_area, 64.0 - 4.0, 0.2);
}

TEST(Radiosity, PatchesAreSmallWhereThingsAreNearAndKeepToTheirMaterial) {
  const Prepared p(roomWithBox(), 128);
  const Sides sides = surfaceSides(p.atlas);
  const auto exposed = exposedShare(p.scene, p.atlas, *p.tracer, sides, 1, 2, nullptr);
  const Patches patches = makePatches(p.scene, p.atlas, *p.tracer, sides, exposed, {.coarsest = 4});
  double near_texels = 0, near = 0, far_texels = 0, far = 0;
  double area = 0;
  for (uint32_t i = 0; i < patches.count(); ++i) {
    area += patches.area[i];
    for (const uint32_t side : patches.sidesOf(i)) EXPECT_EQ(patches.patch_of_side[side], i);
    if (patches.normal[i].y < 0.9f || patches.material[i] != 0) continue;
    const Vec3 at = patches.position[i];
    const float to_box = std::max(std::abs(at.x + 0.3f), std::abs(at.z - 0.3f)) - 1.0f, to_wall = 4.0f - std::max(std::abs(at.x), std::abs(at.z));
    if (to_box < 0.1f || to_wall < 0.1f) near += 1, near_texels += patches.texels_per_side[i];
    if (to_box > 1.2f && to_wall > 1.2f) far += 1, far_texels += patches.texels_per_side[i];
  }
  EXPECT_LT(near_texels / near, 2.0);
  EXPECT_GT(far_texels / far, 2.5);
  EXPECT_NEAR(area, 2 * (64 + 48 + 48) - 4 + 5 * 4, 0.3);
  // A budget is kept, as far as the coarsest squares allow.
  const Patches few = makePatches(p.scene, p.atlas, *p.tracer, sides, exposed, {.coarsest = 4, .most = 900});
  EXPECT_LE(few.count(), 950u);
  EXPECT_LT(few.count(), patches.count());
}

TEST(Radiosity, TheTreeHoldsEveryPatchOnceInEachLevel) {
  const Prepared p(roomWithBox(), 64);
  const Sides sides = surfaceSides(p.atlas);
  const std::vector<float> exposed(sides.slot.size(), 1.0f);
  const Patches patches = makePatches(p.scene, p.atlas, *p.tracer, sides, exposed, {.coarsest = 1});
  const PatchTree tree = makePatchTree(patches);
  ASSERT_GE(tree.levelCount(), 3u);
  for (uint32_t level = 0; level < tree.levelCount(); ++level) {
    uint32_t next = 0;
    double area = 0;
    for (uint32_t node = tree.level_first[level]; node < tree.level_first[level + 1]; ++node) {
      EXPECT_EQ(tree.first_patch[node], next);
      next = tree.end_patch[node];
      area += tree.area[node];
    }
    EXPECT_EQ(next, patches.count());
    EXPECT_NEAR(area, 320 + 20, 0.1);
  }
  EXPECT_LE(tree.level_first[tree.levelCount()] - tree.level_first[tree.levelCount() - 1], PatchTree::kBranching);
}

TEST(Radiosity, CodesAreTheNearestWeights) {
  for (int code = 0; code < 256; ++code) EXPECT_EQ(linkCode(float(linkWeight(uint8_t(code)))), code);
  for (float weight = 16; weight < float(linkWeight(255)); weight *= 1.013f) EXPECT_NEAR(float(linkWeight(linkCode(weight))) / weight, 1.0f, 1.0f / 31);
  EXPECT_EQ(linkCode(0.0f), 0);
  EXPECT_EQ(linkCode(1e30f), 255);
}

TEST(Radiosity, CompressionAddsLittleUnderALightThatItDidNotSee) {
  const Factors f(roomWithBox(), 512, {}, 96);
  const PatchTree tree = makePatchTree(f.patches);
  std::vector<std::vector<float>> direct;
  for (const PriorLight& prior : samplePriorLights(f.p.scene, f.p.atlas, *f.p.tracer, 32, 5))
    direct.push_back(patchIrradiance(f.p.scene, f.p.atlas, *f.p.tracer, f.sides, f.patches, prior.light, 1));
  const RadiosityTraining training = trainRadiosity(f.patches, f.factors, direct);
  LinkOptions exact{.link_error = 1e-9f, .uneven = 0, .prune = 0, .rays = 1u << 30};
  const RadiosityLinks all = quantiseLinks(makeLinks(f.factors, tree, training, exact, 0, f.patches.count()));
  LinkOptions options;
  options.rays = 512;
  LinkValues values = makeLinks(f.factors, tree, training, options, 0, f.patches.count());
  balanceLinks(PortalZones(f.p.scene), f.patches, tree, values);
  const RadiosityLinks links = quantiseLinks(values);
  EXPECT_LT(links.node.size() * 2, all.node.size());
  for (uint32_t row = 0; row < links.rows(); ++row) {
    double sum = 0, exact_sum = 0;
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) sum += double(linkWeight(links.code[l])) * links.row_scale[row];
    for (uint64_t i = f.factors.first[row]; i < f.factors.first[row + 1]; ++i) exact_sum += f.factors.value[i];
    ASSERT_NEAR(sum, exact_sum, 1e-5) << "patch " << row;
  }
  std::vector<Rgb> lit;
  for (const float irradiance : patchIrradiance(f.p.scene, f.p.atlas, *f.p.tracer, f.sides, f.patches, test::pointLight({2.5f, -1, 2}, 10), 1)) lit.emplace_back(irradiance);
  const std::vector<Rgb> dark(f.patches.count(), Rgb(0.0f));
  const auto with_all = solveRadiosity(all, tree, f.patches.albedo_rgb, lit, dark).irradiance_rgb;
  const auto with_links = solveRadiosity(links, tree, f.patches.albedo_rgb, lit, dark).irradiance_rgb;
  double difference2 = 0, square = 0;
  for (size_t i = 0; i < with_all.size(); ++i) {
    difference2 += double((with_links[i] - with_all[i]).length2());
    square += double(with_all[i].length2());
  }
  EXPECT_LT(std::sqrt(difference2 / square), 0.02);
}

TEST(Radiosity, IndirectLightIsThatOfPathTracing) {
  const Prepared p(roomWithBox(), 96);
  RadiositySettings settings = smallSettings();
  settings.rays = 1024;
  const RadiosityResult result = bake(p, settings);
  const scene::Light light = test::pointLight({2, 1, -1}, 10);
  const Sides sides = surfaceSides(p.atlas);
  std::vector<Rgb> lit;
  for (const float irradiance : patchIrradiance(p.scene, p.atlas, *p.tracer, sides, result.patches, light, 1)) lit.emplace_back(irradiance);
  const std::vector<Rgb> dark(result.patches.count(), Rgb(0.0f));
  const auto solution = solveRadiosity(result.links, result.tree, result.patches.albedo_rgb, lit, dark);
  std::vector<std::vector<Rgb>> references;
  for (uint64_t seed = 1; seed <= 3; ++seed)
    references.push_back(referenceIrradiance(p.scene, p.atlas, *p.tracer, {light}, Component::indirect, {.samples = 64, .seed = seed}).irradiance_rgb);
  std::vector<Rgb> candidate(p.atlas.slots.size(), Rgb(0.0f));
  for (size_t i = 0; i < result.texel.size(); ++i)
    for (size_t k = 0; k < 4; ++k)
      if (result.texel_patch[i][k] != kNone)
        candidate[p.atlas.texel_slot[result.texel[i]]] += solution.irradiance_rgb[result.texel_patch[i][k]] * (result.texel_weight[i][k] * result.texel_exposed[i]);
  const PooledError error = compareWithReferences(references, candidate);
  EXPECT_LT(error.relrmse, 0.05);
  EXPECT_LT(error.texrel, 0.12);
  EXPECT_NEAR(error.bias, 0, 0.01);
}

TEST(Radiosity, AClosedRoomKeepsTheEnergyOfALamp) {
  // Each reflection passes on the albedo's part: together the patches receive P (a + a² + …) = P a / (1 − a).
  const Prepared p(test::closedBox({4, 3, 4}, test::diffuse(0.6f)), 96);
  const RadiosityResult result = bake(p, smallSettings());
  const Sides sides = surfaceSides(p.atlas);
  std::vector<Rgb> lit;
  double lamp = 0, received = 0;
  for (const float irradiance : patchIrradiance(p.scene, p.atlas, *p.tracer, sides, result.patches, test::pointLight({2, 1, -1}, 10), 1)) {
    lamp += double(irradiance) * result.patches.area[lit.size()];
    lit.emplace_back(irradiance);
  }
  const std::vector<Rgb> dark(result.patches.count(), Rgb(0.0f));
  const auto solution = solveRadiosity(result.links, result.tree, result.patches.albedo_rgb, lit, dark);
  for (uint32_t i = 0; i < result.patches.count(); ++i) received += double(solution.irradiance_rgb[i].x) * result.patches.area[i];
  EXPECT_NEAR(lamp / (4 * kPi * 10), 1, 0.005);
  EXPECT_NEAR(received / (lamp * 0.6 / 0.4), 1, 0.002);
}

TEST(Radiosity, SealedRoomsWithoutLightHaveNoLinks) {
  // A large room with a lamp, and a small box outside of it: dark, with a lamp of its own, with walls that shine, or as dark as everything.
  enum { dark, lamp, emitter, all_dark };
  for (const int inside : {dark, lamp, emitter, all_dark}) {
    test::SceneBuilder builder;
    const uint32_t wall = builder.material(test::diffuse(0.5f)), small_wall = builder.material(test::diffuse(0.5f, inside == emitter ? 1.0f : 0.0f));
    builder.room({-4, 0, -4}, {4, 4, 4}, wall).room({5, 0, 0}, {5.6f, 0.6f, 0.6f}, small_wall);
    scene::Scene scene = builder.take();
    if (inside != all_dark) scene.lights.push_back(test::pointLight({1, 2, 1}, 5.0f));
    if (inside == lamp) scene.lights.push_back(test::pointLight({5.3f, 0.3f, 0.3f}, 1.0f));
    const Prepared p(std::move(scene), 96);
    const RadiosityResult result = bake(p, smallSettings());
    uint32_t empty = 0, small = 0;
    for (uint32_t i = 0; i < result.patches.count(); ++i) {
      const bool is_small = result.patches.position[i].x > 4.5f, is_empty = result.links.first[i] == result.links.first[i + 1];
      small += is_small;
      empty += is_empty;
      EXPECT_EQ(is_empty, is_small && inside == dark);
    }
    EXPECT_GT(small, 5u);
    EXPECT_EQ(result.dark_patches, inside == dark ? small : 0u);
    EXPECT_EQ(empty, result.dark_patches);
  }
}

TEST(Radiosity, ABlackRoomAndALonePlaneHaveLinksAllTheSame) {
  // What is black may be painted: form factors are there although no training light tells what matters.
  const Prepared black(test::closedBox({1, 1, 1}, test::diffuse(0.0f)), 24);
  const RadiosityResult room = bake(black, smallSettings());
  const std::vector<Rgb> white(room.patches.count(), Rgb(0.5f)), one(room.patches.count(), Rgb(1.0f)), dark(room.patches.count(), Rgb(0.0f));
  for (const Rgb& irradiance_rgb : solveRadiosity(room.links, room.tree, white, one, dark).irradiance_rgb) ASSERT_NEAR(irradiance_rgb.x, 1.0f, 0.01f);
  test::SceneBuilder builder;
  builder.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, builder.material(test::diffuse(0.5f)));
  const Prepared plane(builder.take(), 16);
  EXPECT_TRUE(bake(plane, smallSettings()).links.node.empty());
}

TEST(Radiosity, StagesDependNeitherOnThreadsNorOnHowTheyAreCut) {
  const Prepared p(roomWithBox(), 32);
  RadiositySettings settings = smallSettings();
  settings.rays = 64, settings.training_lights = 8;
  const RadiosityResult a = bake(p, settings, 17, 1), b = bake(p, settings, 256, 3);
  EXPECT_EQ(a.links.first, b.links.first);
  EXPECT_EQ(a.links.node, b.links.node);
  EXPECT_EQ(a.links.code, b.links.code);
  EXPECT_EQ(a.links.row_scale, b.links.row_scale);
  EXPECT_EQ(a.raw_transfers, b.raw_transfers);
}

TEST(Radiosity, DamagedResultsAreRefused) {
  const Prepared p(roomWithBox(), 32);
  const RadiositySettings settings = smallSettings();
  Bytes patches = makePatchBytes(p.scene, p.atlas, *p.tracer, settings, 1, nullptr);
  patches.resize(patches.size() / 2);
  EXPECT_THROW(RadiosityBaker(p.scene, p.atlas, *p.tracer, settings, patches), std::runtime_error);
}

}  // namespace
}  // namespace lightwell::transport
