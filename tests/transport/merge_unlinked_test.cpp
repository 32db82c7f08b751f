// Entry points that nothing tells apart become one, and answers stay what they were.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <numbers>

#include "precompute/transport/prm/bake_prm.h"
#include "precompute/transport/prm/entry_irradiance.h"
#include "precompute/transport/prm/evaluate.h"
#include "precompute/transport/prm/merge_unlinked.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/stages.h"

namespace lightwell::transport {
namespace {

constexpr uint32_t kFirstNode = 4, kFirstDifference = 7;  // of four clusters' wavelets

/// A floor, and what stands on it.
std::unique_ptr<test::PreparedScene> floorWith(const std::function<void(test::SceneBuilder&, uint32_t material)>& things) {
  test::SceneBuilder builder;
  const uint32_t grey = builder.material(test::diffuse(0.5f));
  builder.quad({-1, 0, -1}, {0, 0, 3}, {6, 0, 0}, grey);
  things(builder, grey);
  return std::make_unique<test::PreparedScene>(builder.take(), 32);
}
const test::PreparedScene& inTheOpen() {
  static const auto scene = floorWith([](test::SceneBuilder&, uint32_t) {});
  return *scene;
}

/// Four squares of a floor in a row from x = 0, in pairs, with one block of one texel that links `wavelets`.
PrmResult fourSquares(std::vector<uint32_t> wavelets) {
  PrmResult prm;
  PrmEntries& entries = prm.entries;
  for (int i = 0; i < 4; ++i) {
    entries.position.push_back({float(i) + 0.5f, 0, 0.5f});
    entries.normal.push_back({0, 1, 0});
    entries.half_u.push_back({0.5f, 0, 0}), entries.half_v.push_back({0, 0, 0.5f});
    entries.weight.push_back(1);
  }
  entries.cluster_first_entry = {0, 1, 2, 3, 4};
  prm.texel = {0};
  PrmLocalBases& bases = prm.bases;
  bases.tree.first_leaves = {2, 1, 1};
  bases.tree.first_share = {32768, 32768, 32768};
  bases.block_first_texel = {0, 1};
  bases.block_rank = {1}, bases.basis = {127}, bases.scale = {1, 1, 1};
  for (uint32_t w = 0; w < waveletCount(4); ++w) bases.wavelet_unit.push_back(uint8_t(150 + w));
  for (const uint32_t w : wavelets) {
    bases.link_wavelet.push_back(w);
    for (int channel = 0; channel < 3; ++channel) bases.coefficient.push_back(int8_t(10 + 3 * int(w) + channel));
  }
  bases.block_first_link = {0, uint32_t(wavelets.size())};
  return prm;
}

/// The block's answer to light on the four, before and after; of merged ones the light must be even.
void expectSameAnswer(PrmResult prm, const std::vector<Rgb>& before_rgb, const std::vector<Rgb>& after_rgb) {
  const Rgb before = evaluatePrm(prm, before_rgb)[0];
  mergeUnlinkedClusters(*inTheOpen().tracer, prm);
  ASSERT_EQ(prm.entries.clusterCount(), after_rgb.size());
  const Rgb after = evaluatePrm(prm, after_rgb)[0];
  EXPECT_GT(before.x, 0);
  for (int channel = 0; channel < 3; ++channel) EXPECT_FLOAT_EQ(after[channel], before[channel]);
}

const Rgb kA(1, 2, 3), kB(4, 1, 2), kC(0.5f, 3, 1);

TEST(MergeUnlinked, KeepsAnswersToLightThatIsEvenOnWhatIsOne) {
  expectSameAnswer(fourSquares({2, 3, kFirstNode + 1}), {kA, kA, kB, kC}, {kA, kB, kC});            // the first pair by its mean, the others each
  expectSameAnswer(fourSquares({0, 1, kFirstNode + 2, kFirstDifference}), {kB, kC, kA, kA}, {kB, kC, kA});
  expectSameAnswer(fourSquares({kFirstNode, kFirstDifference}), {kB, kB, kA, kA}, {kB, kA});        // both pairs, and what tells them apart
  expectSameAnswer(fourSquares({kFirstNode}), {kA, kA, kA, kA}, {kA});
  expectSameAnswer(fourSquares({kFirstNode, kFirstDifference + 1}), {kB, kA, kC, kC}, {kB, kA, kC});
}

TEST(MergeUnlinked, OneRectangleStandsForMany) {
  PrmResult prm = fourSquares({kFirstNode});
  EXPECT_EQ(mergeUnlinkedClusters(*inTheOpen().tracer, prm), 3u);
  EXPECT_LT((prm.entries.position[0] - Vec3(2, 0, 0.5f)).length(), 1e-6f);
  EXPECT_LT((prm.entries.normal[0] - Vec3(0, 1, 0)).length(), 1e-6f);
  const Vec3 u = prm.entries.half_u[0], v = prm.entries.half_v[0];
  EXPECT_NEAR(std::max(u.length(), v.length()), 2, 1e-5);
  EXPECT_NEAR(std::min(u.length(), v.length()), 0.5, 1e-5);
  EXPECT_NEAR(u.dot(v), 0, 1e-6);
}

TEST(MergeUnlinked, CornersStepsAndPiecesOfOtherShapesStayApart) {
  const auto mergedAfter = [](auto change) {
    PrmResult prm = fourSquares({kFirstNode});
    change(prm.entries);
    return mergeUnlinkedClusters(*inTheOpen().tracer, prm);
  };
  EXPECT_EQ(mergedAfter([](PrmEntries&) {}), 3u);
  EXPECT_EQ(mergedAfter([](PrmEntries& e) { e.normal[1] = {0, 0.8f, 0.6f}, e.half_v[1] = {0, -0.3f, 0.4f}; }), 1u) << "another wall";
  EXPECT_EQ(mergedAfter([](PrmEntries& e) { e.position[1].y = 0.1f; }), 1u) << "a step";
  EXPECT_EQ(mergedAfter([](PrmEntries& e) { e.position[1].z += 0.5f; }), 1u) << "an L";
  EXPECT_EQ(mergedAfter([](PrmEntries& e) { e.position[1].x += 0.5f; }), 1u) << "a gap";
  EXPECT_EQ(mergedAfter([](PrmEntries& e) { e.half_u[1] = e.half_v[1] = Vec3(0.0f); }), 1u) << "a point has no area";
}

TEST(MergeUnlinked, WallsAndPolesPart) {
  const auto mergedBeside = [](Vec3 corner, Vec3 side) {
    const auto scene = floorWith([&](test::SceneBuilder& builder, uint32_t grey) { builder.quad(corner, {0, 1, 0}, side, grey); });
    PrmResult prm = fourSquares({kFirstNode});
    return mergeUnlinkedClusters(*scene->tracer, prm);
  };
  EXPECT_EQ(mergedBeside({2, 0, -1}, {0, 0, 3}), 2u) << "a wall between the pairs";
  EXPECT_EQ(mergedBeside({2, 0, 0.45f}, {0, 0, 0.1f}), 2u) << "a pole in the middle of all";
  EXPECT_EQ(mergedBeside({1, 0, 0.45f}, {0, 0, 0.1f}), 1u) << "a pole in the middle of a pair";
  EXPECT_EQ(mergedBeside({2, 0.5f, 0}, {0, 0, 1}), 3u) << "a shelf higher up";
}

TEST(MergeUnlinked, WhatProbesLinkStays) {
  PrmResult prm = fourSquares({kFirstNode});
  prm.probes.block_rank = {1};
  prm.probes.link_wavelet = {kFirstDifference + 2};
  prm.probes.coefficient = {1, 2, 3};
  prm.probes.block_first_link = {0, 1};
  EXPECT_EQ(mergeUnlinkedClusters(*inTheOpen().tracer, prm), 1u);
  EXPECT_EQ(prm.probes.link_wavelet, std::vector<uint32_t>{differenceIndex(3, 1)});
  EXPECT_EQ(prm.bases.link_wavelet, std::vector<uint32_t>{meanIndex(3, 0)});
  EXPECT_EQ(prm.bases.tree.children(3).size(), 2u);
}

TEST(MergeUnlinked, AllLightOfALampStillArrivesInAClosedRoom) {
  const test::PreparedScene p(test::closedBox({4, 3, 5}, test::diffuse(0.5f)));
  PrmSettings settings;
  settings.entries.clusters = 2000, settings.entries.groups = 100;
  settings.bases.rays = 128, settings.bases.rank_error = 0.3f, settings.bases.wavelet_step = 0.05f;
  settings.training_lights = 48, settings.cluster_rays = 64;
  const PrmBaker baker(p.scene, p.atlas, *p.tracer, settings);
  using test::views;
  const auto one_bounce = test::inRanges(baker.groupCount(), 16, 2, [&](uint32_t a, uint32_t b) { return baker.oneBounce(a, b); });
  const auto training = test::inRanges(baker.trainingLightCount(), 16, 2, [&](uint32_t a, uint32_t b) { return baker.trainingDirect(a, b); });
  const auto solved = std::make_shared<const Bytes>(baker.solve(views(one_bounce), views(training), {}));
  const auto blocks = test::inRanges(baker.blockCount(), 16, 2, [&](uint32_t a, uint32_t b) { return baker.fit(a, b, solved); });
  PrmResult prm = baker.assemble(views(blocks), {});
  const uint32_t before = prm.entries.clusterCount(), merged = mergeUnlinkedClusters(*p.tracer, prm);
  EXPECT_GT(merged, before / 4);
  EXPECT_EQ(prm.entries.clusterCount(), before - merged);
  scene::Light lamp;
  lamp.intensity = Rgb(1.0f);
  for (const Vec3& position : {Vec3(0.3f, 0.2f, -0.4f), Vec3(1.9f, 1.4f, 2.4f), Vec3(-1.5f, -1.45f, 0)}) {
    lamp.position = position;
    const auto irradiance_rgb = clusterIrradiance(prm.entries, *p.tracer, lamp);
    double flux = 0;
    for (uint32_t c = 0; c < prm.entries.clusterCount(); ++c)
      flux += 4.0 * prm.entries.half_u[c].length() * prm.entries.half_v[c].length() * irradiance_rgb[c].x;
    EXPECT_NEAR(flux, 4 * std::numbers::pi, 0.01 * 4 * std::numbers::pi);
  }
}

}  // namespace
}  // namespace lightwell::transport
