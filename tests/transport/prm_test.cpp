// Precomputed radiance maps against closed forms, against each other and against path tracing.
#include <gtest/gtest.h>

#include <numeric>

#include "precompute/core/parallel.h"
#include "precompute/transport/compare.h"
#include "precompute/transport/prm/bake_prm.h"
#include "precompute/transport/prm/entry_irradiance.h"
#include "precompute/transport/prm/evaluate.h"
#include "precompute/transport/prm/panes.h"
#include "precompute/transport/reference/reference.h"
#include "tests/support/prepared_scene.h"
#include "tests/support/scenes.h"
#include "tests/support/stages.h"

namespace lightwell::transport {
namespace {

using Prepared = test::PreparedScene;

PrmSettings smallSettings(PrmLayoutKind layout) {
  PrmSettings settings;
  settings.layout = layout;
  settings.entries.clusters = layout == PrmLayoutKind::panes ? 48 : 400;
  settings.entries.groups = layout == PrmLayoutKind::panes ? 48 : 100;
  settings.bases.rays = 128;
  settings.bases.block_texels = 64;
  settings.training_lights = 48;
  settings.cluster_rays = 128;
  return settings;
}

/// Runs all stages, cut into ranges of `grain`, on `threads` threads.
PrmResult bake(const PrmBaker& baker, uint32_t grain, int threads) {
  const auto stage = [&](uint32_t count, auto function) { return test::inRanges(count, grain, threads, function); };
  using test::views;
  const auto one_bounce = stage(baker.groupCount(), [&](uint32_t a, uint32_t b) { return baker.oneBounce(a, b); });
  const auto training = stage(baker.trainingLightCount(), [&](uint32_t a, uint32_t b) { return baker.trainingDirect(a, b); });
  const auto emitter = stage(baker.hasEmitters() ? baker.sideCount() : 0, [&](uint32_t a, uint32_t b) { return baker.emitterDirect(a, b); });
  const auto solved = std::make_shared<const Bytes>(baker.solve(views(one_bounce), views(training), views(emitter)));
  const auto blocks = stage(baker.blockCount(), [&](uint32_t a, uint32_t b) { return baker.fit(a, b, solved); });
  return baker.assemble(views(blocks), views(emitter));
}

scene::Scene roomWithBox(float albedo) {
  test::SceneBuilder builder;
  const uint32_t wall = builder.material(test::diffuse(albedo));
  scene::Material red = test::diffuse(albedo);
  red.base_color = Rgb(albedo, 0.2f * albedo, 0.1f * albedo);
  const uint32_t red_wall = builder.material(red);
  builder.room({-4, -3, -4}, {4, 3, 4}, wall);
  builder.quad({-2, -1, -2}, {0, 0, 4}, {3, 0, 0}, red_wall);  // a shelf that faces up …
  builder.quad({-2, -1.1f, -2}, {3, 0, 0}, {0, 0, 4}, wall);   // … and down
  return builder.take();
}

/// Light of the scene's only lamp on all surfaces together, internal units² of irradiance.
double lampLight(const Prepared& p, const EntryClusters& clusters) {
  PrmEntries entries = clusters.entries;  // of fine clusters alone
  entries.cluster_first_entry.resize(clusters.cluster_count + 1);
  double sum = 0;
  const auto irradiance_rgb = clusterIrradiance(entries, *p.tracer, p.scene.lights.front());
  for (uint32_t c = 0; c < clusters.cluster_count; ++c) sum += double(clusters.area[c]) * double(irradiance_rgb[c].x);
  return sum;
}

/// A map over all texels from values in the order of `texel`.
ImageRgba imageOf(const atlas::Atlas& atlas, const std::vector<uint32_t>& texel, const std::vector<Rgb>& value_rgb) {
  ImageRgba image{atlas.width, atlas.height, std::vector<std::array<float, 4>>(size_t(atlas.width) * size_t(atlas.height))};
  for (size_t i = 0; i < texel.size(); ++i) image.pixels[texel[i]] = {value_rgb[i].x, value_rgb[i].y, value_rgb[i].z, 1.0f};
  return image;
}

TEST(PrmEntryPoints, AreFewWhereNoLampReaches) {
  scene::Scene scene = roomWithBox(0.5f);
  scene::Light lamp;
  lamp.position = Vec3(-0.5f, -0.6f, 0);  // low over the shelf: the floor and the walls below lie in the dark
  lamp.intensity = Rgb(10.0f);
  scene.lights = {lamp};
  const Prepared p(std::move(scene));
  PrmSettings settings = smallSettings(PrmLayoutKind::local_bases);
  settings.prior.places = LightPrior::Places::lamps;
  const EntryClusters merged = makePrmEntries(p.scene, p.atlas, *p.tracer, settings);
  settings.merge_unreached = false;
  const EntryClusters all = makePrmEntries(p.scene, p.atlas, *p.tracer, settings);
  EXPECT_EQ(all.merged_clusters, 0u);
  EXPECT_EQ(merged.cluster_count + merged.merged_clusters, all.cluster_count);
  EXPECT_GT(merged.merged_clusters, all.cluster_count / 5);
  EXPECT_EQ(merged.entries.clusterCount(), merged.cluster_count + merged.group_count);
  EXPECT_EQ(merged.group_count, all.group_count);
  EXPECT_NEAR(std::accumulate(merged.area.begin(), merged.area.begin() + merged.cluster_count, 0.0), std::accumulate(all.area.begin(), all.area.begin() + all.cluster_count, 0.0), 1e-3);
  EXPECT_GT(lampLight(p, all), 0);
  EXPECT_NEAR(lampLight(p, merged), lampLight(p, all), 1e-5 * lampLight(p, all)) << "what is lit stays as it is";
  settings.merge_unreached = true;
  settings.prior.places = LightPrior::Places::anywhere;
  EXPECT_EQ(makePrmEntries(p.scene, p.atlas, *p.tracer, settings).merged_clusters, 0u) << "light may come everywhere";
}

TEST(PrmEntryPoints, OfTheDarkStayThere) {
  Prepared p(roomWithBox(0.5f));
  PrmSettings settings = smallSettings(PrmLayoutKind::local_bases);
  settings.prior.places = LightPrior::Places::lamps;
  settings.merge_unreached = false;
  const EntryClusters all = makePrmEntries(p.scene, p.atlas, *p.tracer, settings);
  int beams = 0;
  for (uint32_t g = 0; g < all.group_count; ++g) {
    const uint32_t first = all.group_first_cluster[g], end = all.group_first_cluster[g + 1];
    if (end - first < 4) continue;
    // A beam into the middle of the group, past all of its entry points: the group is dark, as far as they can tell.
    Vec3 middle(0.0f);
    for (uint32_t c = first; c < end; ++c) middle += all.entries.position[c] * (all.area[c] / all.area[all.cluster_count + g]);
    scene::Light lamp;
    lamp.type = scene::LightType::spot;
    lamp.position = middle + all.entries.normal[first] * 0.5f;
    lamp.direction = -all.entries.normal[first];
    lamp.inner_cone_angle = 0.01f, lamp.outer_cone_angle = 0.02f;
    lamp.intensity = Rgb(10.0f);
    p.scene.lights = {lamp};
    if (lampLight(p, all) > 0) continue;
    ++beams;
    settings.merge_unreached = true;
    const EntryClusters merged = makePrmEntries(p.scene, p.atlas, *p.tracer, settings);
    EXPECT_GT(merged.merged_clusters, 0u);
    EXPECT_EQ(lampLight(p, merged), 0) << "what stands for the dark is dark";
    if (beams == 10) break;
  }
  EXPECT_EQ(beams, 10);
}

TEST(PrmFurnace, UnitLightEverywhereInAClosedRoomGivesTheGeometricSeries) {
  // Every ray of a closed room of albedo a meets albedo a, so unit direct irradiance gives a + a² + … = a / (1 − a), whatever the noise.
  for (const float albedo : {0.5f, 0.9f, 0.99f}) {
    Prepared p(test::closedBox({4, 3, 5}, test::diffuse(albedo)));
    for (const auto layout : {PrmLayoutKind::panes, PrmLayoutKind::local_bases}) {
      PrmBaker baker(p.scene, p.atlas, *p.tracer, smallSettings(layout));
      const PrmResult prm = bake(baker, 16, 2);
      const std::vector<Rgb> ones(prm.entries.clusterCount(), Rgb(1.0f));
      const auto irradiance_rgb = evaluatePrm(prm, ones);
      double worst = 0, mean = 0;
      for (const auto& value : irradiance_rgb) {
        worst = std::max(worst, std::abs(double(value.y) * (1 - albedo) / albedo - 1));
        mean += double(value.y) * (1 - albedo) / albedo / double(irradiance_rgb.size());
      }
      EXPECT_NEAR(mean, 1.0, layout == PrmLayoutKind::panes ? 1e-3 : 5e-3) << "albedo " << albedo;
      EXPECT_LT(worst, layout == PrmLayoutKind::panes ? 2e-3 : 0.12) << "albedo " << albedo;
    }
  }
}

TEST(Prm, LocalBasesAgreeWithPathTracingForLightsThatWereNotTrainedOn) {
  Prepared p(roomWithBox(0.6f));
  PrmSettings settings = smallSettings(PrmLayoutKind::local_bases);
  settings.entries.clusters = 1200;
  settings.entries.groups = 200;
  const PrmResult prm = bake(PrmBaker(p.scene, p.atlas, *p.tracer, settings), 16, 2);
  for (const Vec3& position : {Vec3(1, 1, 1), Vec3(-1, 1.5f, 2), Vec3(2, -2, -2)}) {
    const scene::Light light = test::pointLight(position, 10);
    const auto value_rgb = evaluatePrm(prm, clusterIrradiance(prm.entries, *p.tracer, light));
    std::vector<uint32_t> slot_texel;
    for (const auto& slot : p.atlas.slots) slot_texel.push_back(slot.texel);
    const auto reference = [&](uint64_t seed) {
      ReferenceOptions options;
      options.samples = 128;
      options.seed = seed;
      return imageOf(p.atlas, slot_texel,
                     referenceIrradiance(p.scene, p.atlas, *p.tracer, {light}, Component::indirect, options).irradiance_rgb);
    };
    const ImageRgba second = reference(2);
    const MapError error = compareMaps(reference(1), imageOf(p.atlas, prm.texel, value_rgb), &second);
    EXPECT_EQ(error.missing, 0u);
    EXPECT_LT(error.relrmse, 0.10);
    EXPECT_LT(error.texrel, 0.15);
    EXPECT_NEAR(error.bias, 0.0, 0.03);
  }
}

TEST(Prm, TheWalksOfThePaperAndGatheringEstimateTheSamePanes) {
  Prepared p(roomWithBox(0.5f), 32);
  PrmSettings settings = smallSettings(PrmLayoutKind::panes);
  settings.entries.points_per_group = 64;
  settings.walks_per_entry = 4;
  const auto total = [&](PaneEstimator estimator) {
    settings.estimator = estimator;
    const PrmResult prm = bake(PrmBaker(p.scene, p.atlas, *p.tracer, settings), 16, 2);
    const std::vector<Rgb> ones(prm.entries.clusterCount(), Rgb(1.0f));
    // Medians: the walks' geometric term has spikes near corners, which is why gathering is the default.
    std::vector<float> values;
    for (const auto& value : evaluatePrm(prm, ones)) values.push_back(value.y);
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return double(values[values.size() / 2]);
  };
  const double gather = total(PaneEstimator::gather);
  EXPECT_NEAR(total(PaneEstimator::walks) / gather, 1.0, 0.05);
}

TEST(Prm, TheBrightestPanesKeepTheEnergyOfAll) {
  Prepared p(roomWithBox(0.6f), 32);
  PrmBaker baker(p.scene, p.atlas, *p.tracer, smallSettings(PrmLayoutKind::panes));
  const PrmResult prm = bake(baker, 16, 2);
  const auto irradiance_rgb = clusterIrradiance(prm.entries, *p.tracer, test::pointLight({1, 1, 1}, 10));
  const auto sum = [](const std::vector<Rgb>& values) { return std::accumulate(values.begin(), values.end(), Rgb(0.0f)); };
  const Rgb all = sum(evaluatePrm(prm, irradiance_rgb)), some = sum(evaluatePrm(prm, irradiance_rgb, 8));
  for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(some[channel] / all[channel], 1.0f, 1e-3f);
}

TEST(Prm, TheSameBytesForAnyThreadsAndRanges) {
  Prepared p(roomWithBox(0.6f), 24);
  PrmSettings settings = smallSettings(PrmLayoutKind::local_bases);
  settings.bases.rays = 32;
  PrmBaker baker(p.scene, p.atlas, *p.tracer, settings);
  const PrmResult a = bake(baker, 7, 1), b = bake(baker, 13, 3);
  EXPECT_EQ(a.texel, b.texel);
  EXPECT_EQ(a.bases.basis, b.bases.basis);
  EXPECT_EQ(a.bases.coefficient, b.bases.coefficient);
  EXPECT_EQ(a.bases.link_wavelet, b.bases.link_wavelet);
  EXPECT_EQ(a.bases.scale, b.bases.scale);
  EXPECT_EQ(a.bases.wavelet_unit, b.bases.wavelet_unit);
  EXPECT_EQ(a.bases.tree.first_leaves, b.bases.tree.first_leaves);
  EXPECT_EQ(a.bases.tree.first_share, b.bases.tree.first_share);
}

TEST(Prm, ASceneThatReflectsNothingHasNoIndirectLight) {
  Prepared p(test::closedBox({4, 3, 5}, test::diffuse(0.0f)), 16);
  PrmBaker baker(p.scene, p.atlas, *p.tracer, smallSettings(PrmLayoutKind::local_bases));
  const PrmResult prm = bake(baker, 16, 1);
  for (const auto& value : evaluatePrm(prm, clusterIrradiance(prm.entries, *p.tracer, test::pointLight({0, 0, 0}, 10)))) EXPECT_EQ(value, Rgb(0.0f));
}

TEST(Prm, EmittersGiveTheFurnaceItsConstantPane) {
  // Closed room, emission 1, albedo a: direct irradiance is π, indirect π a / (1 − a).
  Prepared p(test::closedBox({4, 3, 5}, test::diffuse(0.5f, 1.0f)), 24);
  PrmBaker baker(p.scene, p.atlas, *p.tracer, smallSettings(PrmLayoutKind::local_bases));
  const PrmResult prm = bake(baker, 16, 2);
  ASSERT_EQ(prm.emitter_direct_rgb.size(), prm.texel.size());
  double direct = 0, indirect = 0;
  for (size_t i = 0; i < prm.texel.size(); ++i) {
    direct += prm.emitter_direct_rgb[i].y / double(prm.texel.size());
    indirect += prm.emitter_indirect_rgb[i].y / double(prm.texel.size());
  }
  EXPECT_NEAR(direct, kPi, 0.02 * kPi);
  EXPECT_NEAR(indirect, kPi, 0.02 * kPi);
}

TEST(PrmPartition, EveryElementOnceAndNoGroupWiderThanAsked) {
  std::vector<SurfaceElement> elements;
  for (int i = 0; i < 2000; ++i) {
    const float angle = 0.013f * float(i);
    elements.push_back({Vec3(std::cos(angle), std::sin(angle), 0.001f * float(i)), Vec3(std::cos(angle), std::sin(angle), 0)});
  }
  const Partition partition = partitionByExtent(elements, 0.3f, 0.5f, 40);
  std::vector<int> seen(elements.size(), 0);
  for (uint32_t g = 0; g < partition.count(); ++g) {
    EXPECT_LE(partition.first[g + 1] - partition.first[g], 40u);
    Box3 positions, normals;
    for (uint32_t i = partition.first[g]; i < partition.first[g + 1]; ++i) {
      ++seen[partition.order[i]];
      positions.extendBy(elements[partition.order[i]].position);
      normals.extendBy(elements[partition.order[i]].normal);
    }
    EXPECT_LE(maxComponent(positions.size()), 0.3f + 1e-5f);
    EXPECT_LE(maxComponent(normals.size()), 0.5f + 1e-5f);
  }
  EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), int(elements.size()));
  EXPECT_NEAR(partitionByCount(elements, 100, 0.5f, 2000).count(), 100, 25);
}

}  // namespace
}  // namespace lightwell::transport
