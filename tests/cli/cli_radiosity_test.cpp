// Radiosity from the scene to the evaluated atlas: a closed room, whose light is known, on both evaluators.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

class CliRadiosityTest : public CommandTest {
 protected:
  void SetUp() override {
    writeFile(path("lamp.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1}));
    run({"bake", path("lamp.gltf"), "-o", path("r.lwc"), "--techniques", "radiosity", "--lightmap-size", "32", "--quality", "draft"});
  }
  double evaluate(const std::string& component, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"evaluate", path("r.lwc"), "--technique", "radiosity", "--component", component, "-o", path("e.exr")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
    return meanOf("e.exr");
  }
};

TEST_F(CliRadiosityTest, ClosedRoomsKeepTheLampsEnergy) {
  const double direct = 4 * std::numbers::pi / 24, indirect = direct / 0.3 - direct;  // 24 m², albedo 0.7, 1 cd
  EXPECT_NEAR(evaluate("indirect") / indirect, 1, 0.02);
  EXPECT_NEAR(evaluate("total") / (direct + indirect), 1, 0.02);
  EXPECT_NEAR(evaluate("indirect", {"--injection", "64"}) / indirect, 1, 0.02);
  EXPECT_NEAR(evaluate("indirect", {"--injection", "64", "--evaluator", "gl"}) / evaluate("indirect", {"--injection", "64"}), 1, 1e-3);
  EXPECT_NEAR(evaluate("indirect", {"--evaluator", "gl"}) / evaluate("indirect"), 1, 1e-4);
}

TEST_F(CliRadiosityTest, ProbesAreBakedListedAndLit) {
  writeFile(path("points.json"), R"({"probes": [[0.5, 0.5, 0.5], [1.2, 0.8, 0.6]]})");
  const std::vector<std::string> bake{"bake", path("lamp.gltf"), "-o", path("p.lwc"), "--techniques", "radiosity", "--lightmap-size", "32", "--quality", "draft"};
  auto with_probes = bake;
  with_probes.insert(with_probes.end(), {"--probe-spacing", "0.5", "--probes", path("points.json")});
  run(with_probes);
  run({"verify", path("p.lwc")});
  const auto info = runJson({"info", path("p.lwc"), "--json"}, "info");
  const auto& probes = info["content"]["probes"];
  EXPECT_GT(probes["lattice_probes"].get<int>(), 20);
  EXPECT_EQ(probes["points"], 2);
  EXPECT_NEAR(probes["lattice_spacing_m"].get<double>(), 0.5, 1e-6);

  // In the middle of a closed room about what its walls reflect on the mean: albedo × all light of the lamp.
  const double reflected = 0.7 * 4 * std::numbers::pi / 24 / 0.3;
  nlohmann::json light[2];
  for (const char* evaluator : {"cpu", "gl"}) {
    run({"evaluate", path("p.lwc"), "--technique", "radiosity", "--component", "indirect", "--evaluator", evaluator, "-o", path("e.exr"), "--probes-out", path("light.json")});
    nlohmann::json& document = light[evaluator[0] == 'g'];
    document = nlohmann::json::parse(readFile(path("light.json")));
    EXPECT_EQ(schemaViolation(readSchema("probes"), document), "");
    const auto& point = document["probes"][probes["lattice_probes"].get<size_t>()];
    EXPECT_NEAR(point["position"][1].get<double>(), 0.5, 1e-5);
    EXPECT_NEAR(point["radiance_sh"][0][0].get<double>() * 0.28209479 * std::numbers::pi / reflected, 1, 0.1);
  }
  for (size_t i = 0; i < light[0]["probes"].size(); ++i)
    EXPECT_NEAR(light[0]["probes"][i]["radiance_sh"][0][0].get<double>(), light[1]["probes"][i]["radiance_sh"][0][0].get<double>(), 1e-3);

  // Without being asked for there is no byte of them; they are nothing without radiosity.
  const auto plain = runJson({"info", path("r.lwc"), "--json"}, "info");
  EXPECT_FALSE(plain["content"].contains("probes"));
  EXPECT_EQ(lightwell({"evaluate", path("r.lwc"), "--technique", "radiosity", "-o", path("e.exr"), "--probes-out", path("light.json")}).exit_code, 2);
  EXPECT_EQ(lightwell({"bake", path("lamp.gltf"), "-o", path("q.lwc"), "--techniques", "prm", "--probe-spacing", "auto"}).exit_code, 2);
  EXPECT_EQ(lightwell({"bake", path("lamp.gltf"), "-o", path("q.lwc"), "--techniques", "radiosity", "--probe-spacing", "some"}).exit_code, 2);
  writeFile(path("points.json"), R"({"probes": [[0.5, 0.5]]})");
  EXPECT_EQ(lightwell(with_probes).exit_code, 3);
}

// Two estimators that share nothing but the scene: sums over wavelets of clusters, and links to nodes of patches.
TEST_F(CliRadiosityTest, ProbesOfRadianceMapsAgreeWithThoseOfPatches) {
  writeFile(path("points.json"), R"({"probes": [[0.5, 0.5, 0.5], [1.2, 0.8, 0.6], [0.3, 0.2, 0.7], [1.8, 0.4, 0.3]]})");
  run({"bake", path("lamp.gltf"), "-o", path("both.lwc"), "--techniques", "prm,radiosity", "--lightmap-size", "64", "--quality", "preview", "--probes", path("points.json")});
  run({"verify", path("both.lwc")});
  const auto info = runJson({"info", path("both.lwc"), "--json"}, "info");
  EXPECT_EQ(info["content"]["prm_probes"]["probes"], 4);
  nlohmann::json light[2];
  for (const char* technique : {"prm", "radiosity"}) {
    run({"evaluate", path("both.lwc"), "--technique", technique, "--component", "indirect", "-o", path("e.exr"), "--probes-out", path("light.json")});
    light[technique[0] == 'r'] = nlohmann::json::parse(readFile(path("light.json")));
  }
  EXPECT_EQ(schemaViolation(readSchema("probes"), light[0]), "");
  const double band[] = {std::numbers::pi, 2 * std::numbers::pi / 3, std::numbers::pi / 4};
  // Of all light, and of how it differs by direction, which is little in a closed room.
  double square = 0, difference = 0, uneven_square = 0, uneven_difference = 0, mean[2] = {};
  for (size_t i = 0; i < 4; ++i)
    for (size_t k = 0; k < 9; ++k) {
      const double a = band[k == 0 ? 0 : k < 4 ? 1 : 2];
      double v[2];
      for (int t = 0; t < 2; ++t) v[t] = a * light[t]["probes"][i]["radiance_sh"][k][1].get<double>();
      square += v[1] * v[1], difference += (v[0] - v[1]) * (v[0] - v[1]);
      if (k == 0) mean[0] += v[0], mean[1] += v[1];
      else uneven_square += v[1] * v[1], uneven_difference += (v[0] - v[1]) * (v[0] - v[1]);
      EXPECT_EQ(light[0]["probes"][i]["position"], light[1]["probes"][i]["position"]);
    }
  EXPECT_LT(std::sqrt(difference / square), 0.05);
  EXPECT_LT(std::sqrt(uneven_difference / uneven_square), 0.5);
  EXPECT_NEAR(mean[0] / mean[1], 1, 0.03);
  EXPECT_EQ(lightwell({"bake", path("lamp.gltf"), "-o", path("q.lwc"), "--techniques", "prm", "--prm-layout", "panes", "--probes", path("points.json")}).exit_code, 2);
  EXPECT_EQ(lightwell({"bake", path("lamp.gltf"), "-o", path("q.lwc"), "--techniques", "lightmap", "--probes", path("points.json")}).exit_code, 2);
}

TEST_F(CliRadiosityTest, IsListedAndSound) {
  run({"verify", path("r.lwc")});
  const auto radiosity = runJson({"info", path("r.lwc"), "--json"}, "info")["content"]["radiosity"];
  EXPECT_GT(radiosity["patches"].get<int>(), 20);
  EXPECT_GT(radiosity["links"].get<int>(), radiosity["patches"].get<int>());
  EXPECT_EQ(radiosity["has_emission"], false);
  EXPECT_EQ(radiosity["portals"].size(), 0u);
  const Finished wrong = lightwell({"evaluate", path("r.lwc"), "--technique", "prm", "--injection", "64", "-o", path("e.exr")});
  EXPECT_EQ(wrong.exit_code, 2) << wrong.err;
}

class CliPortalTest : public CommandTest {
 protected:
  std::vector<std::string> bake(const std::string& scene, const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"bake", path(scene), "-o", path(out), "--lightmap-size", "48", "--quality", "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  std::vector<std::string> evaluate(const std::string& container, const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"evaluate", path(container), "--technique", "radiosity", "--component", "indirect", "-o", path("e.exr")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  double errorAgainst(const std::string& reference) {
    return runJson({"compare", path(reference), path("e.exr"), "--json"}, "compare")["relrmse"].get<double>();
  }
};

TEST_F(CliPortalTest, OpenAsFarAsTheyAreTold) {
  writeFile(path("s.gltf"), roomGltf({.albedo = 0.6, .lamp_candela = 1, .shutter = true}));
  run(bake("s.gltf", "s.lwc", {"--techniques", "radiosity"}));
  run({"verify", path("s.lwc")});
  const auto portals = runJson({"info", path("s.lwc"), "--json"}, "info")["content"]["radiosity"]["portals"];
  ASSERT_EQ(portals.size(), 1u);
  EXPECT_EQ(portals[0]["name"], "shutter");
  EXPECT_EQ(portals[0]["strips"], 4);
  EXPECT_EQ(portals[0]["triangles"], 2);
  for (const std::string open : {"0", "0.5", "1"}) {
    run({"reference", path("s.gltf"), "--component", "indirect", "--lightmap-size", "48", "--samples", "1024", "--portal", "shutter=" + open, "-o", path("r.exr")});
    run(evaluate("s.lwc", {"--portal", "shutter=" + open}));
    EXPECT_LT(errorAgainst("r.exr"), 0.06) << open;
  }
  for (const std::string open : {"0", "0.3", "0.5", "1"}) {
    run(evaluate("s.lwc", {"--portal", "shut*=" + open, "--injection", "128"}));
    std::filesystem::rename(path("e.exr"), path("cpu.exr"));
    run(evaluate("s.lwc", {"--portal", "shut*=" + open, "--injection", "128", "--evaluator", "gl"}));
    EXPECT_LT(errorAgainst("cpu.exr"), 0.005) << open;
  }
}

TEST_F(CliPortalTest, AreDrawnAsFarAsTheyAreOpen) {
  writeFile(path("s.gltf"), roomGltf({.albedo = 0.6, .lamp_candela = 1, .shutter = true}));
  run(bake("s.gltf", "s.lwc", {"--techniques", "radiosity"}));
  writeFile(path("camera.json"), R"({"eye": [0.9, 0.1, 0.8], "target": [-0.6, 0, -0.5], "vertical_fov_deg": 80, "width": 64, "height": 48, "exposure": 2})");
  const auto picture = [&](const std::string& open) {
    run({"render", path("s.lwc"), "--camera", path("camera.json"), "--technique", "radiosity", "--portal", "shut*=" + open, "-o", path("p.png")});
    return readFile(path("p.png"));
  };
  const std::string shut = picture("0"), half = picture("0.5");
  EXPECT_NE(shut, half);
  EXPECT_EQ(shut, picture("0"));
  EXPECT_NE(half, picture("1"));
  EXPECT_EQ(lightwell({"render", path("s.lwc"), "--camera", path("camera.json"), "--portal", "gate=1", "-o", path("p.png")}).exit_code, 2);
}

TEST_F(CliPortalTest, AreNamedByOptions) {
  writeFile(path("plain.gltf"), roomGltf({.albedo = 0.6, .lamp_candela = 1, .shutter = true, .shutter_marked = false}));
  run(bake("plain.gltf", "plain.lwc"));
  EXPECT_FALSE(runJson({"info", path("plain.lwc"), "--json"}, "info")["content"].contains("radiosity")) << "auto has radiosity for portals alone";
  run(bake("plain.gltf", "a.lwc", {"--portal", "shut*", "--threads", "1"}));
  run(bake("plain.gltf", "b.lwc", {"--portal", "shut*", "--threads", "3"}));
  EXPECT_EQ(readFile(path("a.lwc")), readFile(path("b.lwc")));
  EXPECT_EQ(runJson({"info", path("a.lwc"), "--json"}, "info")["content"]["radiosity"]["portals"][0]["strips"], 8);
  EXPECT_THAT(run({"info", path("a.lwc")}).out, testing::HasSubstr("the scene has portals"));

  const auto unknown = lightwell(bake("plain.gltf", "c.lwc", {"--portal", "gate"}));
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, testing::HasSubstr("shutter"));
  EXPECT_EQ(lightwell(evaluate("a.lwc", {"--portal", "gate=0.5"})).exit_code, 2);
  EXPECT_EQ(lightwell(evaluate("a.lwc", {"--portal", "shutter=2"})).exit_code, 2);
  EXPECT_EQ(lightwell(evaluate("a.lwc", {"--portal", "shutter"})).exit_code, 2);
  EXPECT_EQ(lightwell({"evaluate", path("a.lwc"), "--technique", "prm", "--portal", "shutter=1", "-o", path("e.exr")}).exit_code, 2);
}

}  // namespace
}  // namespace lightwell::test
