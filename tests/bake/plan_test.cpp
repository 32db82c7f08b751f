// The plan follows from the scene: nothing is planned that the scene has no use for, and everything left out is explained.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "precompute/core/error.h"
#include "precompute/plan/light_paths.h"
#include "precompute/plan/plan.h"
#include "precompute/plan/probe_points.h"
#include "precompute/plan/texel_density.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::plan {
namespace {

constexpr SceneFacts kRoom{.has_surfaces = true, .has_emitters = true, .has_reflection = true};

bool omits(const Plan& plan, const std::string& type) {
  return std::any_of(plan.omitted.begin(), plan.omitted.end(), [&](const Omitted& o) { return o.type == type && !o.reason.empty(); });
}

TEST(Plan, AutoBakesPrmAndExplainsTheRest) {
  const Plan plan = makePlan(kRoom, {});
  EXPECT_TRUE(plan.prm && plan.prm_emitter && plan.atlas && plan.geometry);
  for (const char* type : {"lightmap", "vpl", "radiosity", "environment"}) EXPECT_TRUE(omits(plan, type)) << type;
  EXPECT_FALSE(omits(plan, "prm"));
}

TEST(TexelDensity, FollowsTheErrorAndNotTheUnitOfLength) {
  const auto chosen = [](float scale, double target) { return chooseLightmapSize(test::closedBox(Vec3(1, 0.7f, 1.4f) * scale, test::diffuse(0.5f)), target, 1, 2, nullptr); };
  ChosenSize last = chosen(1, 0.4);
  EXPECT_LE(last.variation, 0.4);
  for (const double target : {0.2, 0.1, 0.05}) {
    const ChosenSize next = chosen(1, target);
    EXPECT_LE(next.variation, target);
    EXPECT_GT(next.size, last.size);
    last = next;
  }
  const ChosenSize kilometres = chosen(1024, 0.1), metres = chosen(1, 0.1);
  EXPECT_EQ(kilometres.size, metres.size);
  EXPECT_NEAR(kilometres.variation, metres.variation, 1e-3);
  EXPECT_EQ(chooseLightmapSize({}, 0.1, 1, 2, nullptr).size, kLeastChosenSize);
}

TEST(Plan, NoEmittersNoEmitterPanes) {
  const Plan plan = makePlan({.has_surfaces = true, .has_emitters = false, .has_reflection = true}, {});
  EXPECT_TRUE(plan.prm);
  EXPECT_FALSE(plan.prm_emitter);
  EXPECT_TRUE(omits(plan, "prm.emitter"));
}

TEST(Plan, NothingToBakeWithoutSurfacesOrReflection) {
  const Plan empty = makePlan({}, {});
  EXPECT_FALSE(empty.prm || empty.atlas || empty.geometry);
  for (const char* type : {"prm", "geometry", "atlas"}) EXPECT_TRUE(omits(empty, type)) << type;
  const Plan black = makePlan({.has_surfaces = true}, {});
  EXPECT_TRUE(black.atlas && omits(black, "prm"));
}

TEST(Plan, ASkyIsBakedWhenThereIsOne) {
  const Plan none = makePlan(kRoom, {});
  EXPECT_TRUE(omits(none, "environment") && omits(none, "prm.sky"));
  SceneFacts outside = kRoom;
  outside.has_environment = outside.has_sky_light = true;
  const Plan both = makePlan(outside, {});
  EXPECT_TRUE(both.prm && both.prm_sky && both.environment);
  EXPECT_FALSE(omits(both, "environment") || omits(both, "prm.sky"));
  Settings only_prm;
  only_prm.techniques = {Technique::prm};
  const Plan panes = makePlan(outside, only_prm);
  EXPECT_TRUE(panes.prm_sky && !panes.environment && omits(panes, "environment"));
  outside.has_sky_light = false;
  const Plan black = makePlan(outside, {});
  EXPECT_TRUE(omits(black, "environment") && omits(black, "prm.sky"));
  const Plan sky = makePlan({.has_scene = false, .has_environment = true, .has_sky_light = true}, {});
  EXPECT_TRUE(sky.environment && !sky.atlas && !sky.prm && !sky.prm_sky);
  for (const char* type : {"scene", "geometry", "atlas", "prm"}) EXPECT_TRUE(omits(sky, type)) << type;
}

TEST(Plan, ASkyThatNothingSeesIsLeftOutUnlessAsked) {
  SceneFacts shut = kRoom;
  shut.has_environment = shut.has_sky_light = true;
  shut.sees_sky = false;
  shut.probing_rays = 65536;
  const Plan plan = makePlan(shut, {});
  EXPECT_TRUE(plan.prm && omits(plan, "environment") && omits(plan, "prm.sky"));
  EXPECT_THAT(plan.omitted, testing::Contains(testing::Field(&Omitted::reason, testing::HasSubstr("65536 rays"))));
  Settings settings;
  settings.keep_all = true;
  EXPECT_TRUE(makePlan(shut, settings).environment && makePlan(shut, settings).prm_sky);
  settings = {};
  settings.techniques = {Technique::environment};
  EXPECT_TRUE(makePlan(shut, settings).environment) << "asked for by name";
}

TEST(Plan, WhatMovesDecidesBetweenRadianceMapsAndALightMap) {
  SceneFacts lit = kRoom;
  lit.has_lamps = true;
  Settings settings;
  settings.moving_lights = MovingLights::none;
  const Plan still = makePlan(lit, settings);
  EXPECT_TRUE(still.lightmap && !still.prm && omits(still, "prm") && omits(still, "vpl"));
  EXPECT_FALSE(still.prm_emitter || omits(still, "lightmap"));
  for (const auto lights : {MovingLights::ceilings, MovingLights::sun, MovingLights::lamps}) {
    settings.moving_lights = lights;
    EXPECT_TRUE(makePlan(lit, settings).prm && !makePlan(lit, settings).lightmap);
  }
  settings.moving_lights = MovingLights::paths;
  EXPECT_THROW(makePlan(lit, settings), UsageError) << "paths without points";
  settings.light_paths_m = {{{0, 1, 0}, {2, 1, 0}}};
  EXPECT_TRUE(makePlan(lit, settings).prm);
  EXPECT_EQ(canonicalJson(settingsFromJson(canonicalJson(settings))), canonicalJson(settings));
}

TEST(Plan, GeometryIsLeftOutForAGameThatHasItsOwn) {
  Settings settings;
  settings.geometry = false;
  const Plan plan = makePlan(kRoom, settings);
  EXPECT_TRUE(plan.prm && plan.atlas && !plan.geometry && omits(plan, "geometry"));
  settings.techniques = {Technique::vpl};
  EXPECT_THROW(makePlan(kRoom, settings), UsageError) << "virtual lights cast shadows from it";
}

TEST(Plan, RadiosityIsBakedWhenAskedFor) {
  EXPECT_FALSE(makePlan(kRoom, {}).radiosity);
  EXPECT_TRUE(omits(makePlan(kRoom, {}), "radiosity"));
  Settings settings;
  settings.techniques = {Technique::radiosity};
  const Plan plan = makePlan(kRoom, settings);
  EXPECT_TRUE(plan.radiosity && !plan.prm && omits(plan, "prm"));
  EXPECT_TRUE(makePlan({.has_surfaces = true}, settings).radiosity) << "a black room may be painted";
  EXPECT_TRUE(omits(makePlan({}, settings), "radiosity"));
  EXPECT_TRUE(omits(plan, "probes")) << "nobody asked for them";
  settings.probe_spacing_m = 0.5f;
  EXPECT_TRUE(makePlan(kRoom, settings).probes);
  settings.techniques = {Technique::prm};
  EXPECT_THROW(makePlan(kRoom, settings), UsageError) << "probes without radiosity";
  settings.techniques = {Technique::radiosity};
  settings.probe_spacing_m = 0;
  settings.radiosity_density = 0.01f;
  EXPECT_THROW(makePlan(kRoom, settings), UsageError);
}

TEST(Plan, NumbersThatNoEnvironmentCanHaveAreAUsageError) {
  Settings settings;
  settings.environment_samples = 0;
  EXPECT_THROW(makePlan(kRoom, settings), UsageError);
  settings.environment_samples = 64;
  settings.sky_face_cells = 65;
  EXPECT_THROW(makePlan(kRoom, settings), UsageError);
}

TEST(Plan, OnlyALightMapIsDirectional) {
  SceneFacts lit = kRoom;
  lit.has_lamps = true;
  Settings settings;
  settings.directional = true;
  settings.techniques = {Technique::lightmap};
  EXPECT_TRUE(makePlan(lit, settings).lightmap);
  settings.techniques = {};
  EXPECT_THROW(makePlan(lit, settings), UsageError);
}

TEST(Plan, VirtualLightsAreBakedWhenAskedFor) {
  SceneFacts lit = kRoom;
  lit.has_lamps = true;
  EXPECT_TRUE(omits(makePlan(lit, {}), "vpl"));
  Settings settings;
  settings.techniques = {Technique::vpl};
  settings.virtual_lights = 100;
  EXPECT_TRUE(makePlan(lit, settings).vpl);
  lit.has_lamps = lit.has_emitters = false;
  EXPECT_TRUE(omits(makePlan(lit, settings), "vpl")) << "nothing shines";
  settings.techniques = {Technique::prm};
  EXPECT_THROW(makePlan(lit, settings), UsageError) << "virtual lights without vpl";
}

TEST(Plan, ChoicesOfPrmThatExcludeEachOtherAreAUsageError) {
  Settings walks;
  walks.prm_estimator = PrmEstimator::walks;
  EXPECT_THROW(makePlan(kRoom, walks), UsageError);
  walks.prm_layout = PrmLayout::panes;
  EXPECT_TRUE(makePlan(kRoom, walks).prm);
  walks.prm_clusters = kMostPrmPanes + 1;
  EXPECT_THROW(makePlan(kRoom, walks), UsageError);
  Settings few;
  few.prm_clusters = 256;
  few.prm_entries = 255;
  EXPECT_THROW(makePlan(kRoom, few), UsageError);
}

TEST(Settings, TechniquesParse) {
  EXPECT_TRUE(parseTechniques("auto").empty());
  EXPECT_THAT(parseTechniques("vpl,prm,vpl"), testing::ElementsAre(Technique::prm, Technique::vpl));
  for (const char* bad : {"", "prm,", "auto,prm", "PRM", "prm vpl"}) EXPECT_THROW(parseTechniques(bad), UsageError) << bad;
}

TEST(Settings, CanonicalJsonRoundTrips) {
  Settings settings;
  settings.techniques = {Technique::prm};
  settings.lightmap_size = 33;
  settings.quality = Quality::draft;
  settings.refinement = -2;
  settings.seed = 0xffffffffffffffffull;
  settings.light_units = scene::LightUnits::raw;
  settings.prm_layout = PrmLayout::panes;
  settings.prm_estimator = PrmEstimator::walks;
  settings.prm_entries = 4096;
  settings.prm_clusters = 256;
  settings.radiosity_density = 0.5f;
  settings.probe_spacing_m = kAutomaticProbeSpacing;
  settings.probe_points_m = {{1.5, -2, 0.25}};
  settings.directional = true;
  settings.virtual_light = VirtualLightShape::disk;
  settings.virtual_lights = 77;
  settings.virtual_bounces = 3;
  settings.points = 4096;
  settings.moving_lights = MovingLights::paths;
  settings.light_paths_m = {{{1, 2, 3}, {4, 5, 6}}, {{0.5, 0, 0}}};
  settings.geometry = false;
  settings.keep_all = true;
  settings.environment_samples = 32;
  settings.sky_face_cells = 128;
  settings.environment = {.rotation_deg = -90, .intensity = 0.5f, .ground_radiance_rgb = {{1, 2, 0.25f}}};
  const std::string json = canonicalJson(settings);
  EXPECT_EQ(canonicalJson(settingsFromJson(json)), json);
  EXPECT_EQ(json,
            R"({"directional":true,"environment_ground":[1.0,2.0,0.25],"environment_intensity":0.5,"environment_rotation_deg":-90.0,"environment_samples":32,"geometry":false,"keep_all":true,)"
            R"("light_paths_m":[[[1.0,2.0,3.0],[4.0,5.0,6.0]],[[0.5,0.0,0.0]]],"light_units":"raw","lightmap_size":33,"moving_lights":"paths","points":4096,"portals":[],"prm_clusters":256,"prm_entries":4096,"prm_estimator":"walks","prm_layout":"panes",)"
            R"("probe_points_m":[[1.5,-2.0,0.25]],"probe_spacing_m":"auto","quality":"draft","radiosity_density":0.5,"refinement":-2,"seed":18446744073709551615,"sky_face_cells":128,"techniques":["prm"],"virtual_bounces":3,"virtual_light":"disk","virtual_lights":77})");
  EXPECT_EQ(settingsFromJson(json).environment, settings.environment);
  EXPECT_EQ(canonicalJson(settingsFromJson("{}")), canonicalJson(Settings{}));
}

TEST(Settings, JsonIsChecked) {
  for (const char* bad : {"", "[]", "{", R"({"quality":"best"})", R"({"quality":1})", R"({"lightmap_size":0})", R"({"lightmap_size":8193})",
                          R"({"lightmap_size":1.5})", R"({"seed":-1})", R"({"refinement":4})", R"({"refinement":-7})", R"({"threads":2})",
                          R"({"techniques":[1]})", R"({"light_units":null})", R"({"prm_layout":"pane"})", R"({"prm_estimator":0})",
                          R"({"prm_entries":-1})", R"({"prm_clusters":65537})", R"({"environment_samples":4097})",
                          R"({"sky_face_cells":257})", R"({"environment_intensity":-1})", R"({"environment_rotation_deg":361})",
                          R"({"environment_ground":[1,2]})", R"({"environment_ground":[1,2,-3]})"})
    EXPECT_THROW(settingsFromJson(bad), UsageError) << bad;
}

/// A list of so many points at the origin, as JSON.
std::string origins(size_t count) {
  std::string list = "[";
  for (size_t i = 0; i < count; ++i) list += i ? ",[0,0,0]" : "[0,0,0]";
  return list + "]";
}

TEST(Plan, FilesAndSettingsNameNoMorePointsThanTheLimits) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "points.json";
  const auto refused = [&](auto read, const std::string& text) -> std::string {
    std::ofstream(file) << text;
    try {
      read(file);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_EQ(refused(readProbePoints, R"({"probes":)" + origins(65536) + "}"), "");
  EXPECT_THAT(refused(readProbePoints, R"({"probes":)" + origins(65537) + "}"), testing::HasSubstr("has 65537 points; 1 to 65536 can be baked"));
  EXPECT_EQ(refused(readLightPaths, R"({"paths":[)" + origins(65535) + "," + origins(1) + "]}"), "");
  EXPECT_THAT(refused(readLightPaths, R"({"paths":[)" + origins(65536) + "," + origins(1) + "]}"), testing::HasSubstr("have 65537 points together"));
  Settings settings;
  settings.probe_points_m.resize(65536);
  settings.light_paths_m = {std::vector<std::array<double, 3>>(65536)};
  EXPECT_NO_THROW(settingsFromJson(canonicalJson(settings)));
  Settings probes = settings, paths = settings;
  probes.probe_points_m.emplace_back();
  paths.light_paths_m.emplace_back(1);
  EXPECT_THROW(settingsFromJson(canonicalJson(probes)), UsageError);
  EXPECT_THROW(settingsFromJson(canonicalJson(paths)), UsageError);
}

}  // namespace
}  // namespace lightwell::plan
