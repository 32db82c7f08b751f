// Light maps from the scene to the evaluated atlas: a closed room, whose light is known, on both evaluators.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class CliLightmapTest : public CommandTest {
 protected:
  void SetUp() override { writeFile(path("lamp.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1})); }
  std::vector<std::string> bakeTo(const std::string& file, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"bake", path("lamp.gltf"), "-o", path(file), "--techniques", "lightmap", "--lightmap-size", "32"};
    if (std::find(more.begin(), more.end(), "--quality") == more.end()) arguments.insert(arguments.end(), {"--quality", "draft"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  double evaluate(const std::string& component, const std::string& evaluator = "cpu") {
    run({"evaluate", path("m.lwc"), "--technique", "lightmap", "--component", component, "--evaluator", evaluator, "-o", path("e.exr")});
    return meanOf("e.exr");
  }
};

TEST_F(CliLightmapTest, AClosedRoomKeepsTheLampsEnergyOnBothEvaluators) {
  run(bakeTo("m.lwc"));
  run({"verify", path("m.lwc")});
  const double direct = 4 * std::numbers::pi / 24, indirect = direct / 0.3 - direct;  // 24 m², albedo 0.7, 1 cd
  for (const char* evaluator : {"cpu", "gl"}) {
    EXPECT_NEAR(evaluate("direct", evaluator) / direct, 1, 0.01);
    EXPECT_NEAR(evaluate("indirect", evaluator) / indirect, 1, 0.02);
    EXPECT_NEAR(evaluate("total", evaluator) / (direct + indirect), 1, 0.02);
  }
  EXPECT_THAT(run({"info", path("m.lwc")}).out, HasSubstr("lightmap"));
}

TEST_F(CliLightmapTest, HasTheLightsItWasBakedWithAndNoOthers) {
  writeFile(path("bright.json"), R"({"lights": [{"type": "point", "position": [0.2, 0.3, 0.1], "color": [1, 1, 1], "intensity": 5}]})");
  writeFile(path("none.json"), R"({"lights": []})");
  run(bakeTo("m.lwc", {"--lights", path("bright.json")}));
  EXPECT_NEAR(evaluate("total") / (5 * 4 * std::numbers::pi / 24 / 0.3), 1, 0.02);
  const Finished relit = lightwell({"evaluate", path("m.lwc"), "--technique", "lightmap", "--lights", path("none.json"), "-o", path("e.exr")});
  EXPECT_EQ(relit.exit_code, 2);
  EXPECT_THAT(relit.err, HasSubstr("bake --lights"));
  // Nothing shines: nothing is stored, and info says why.
  run(bakeTo("m.lwc", {"--lights", path("none.json")}));
  EXPECT_THAT(run({"info", path("m.lwc")}).out, HasSubstr("without lightmap: nothing shines"));
}

TEST_F(CliLightmapTest, IsDrawnWithItsOwnLampsOnly) {
  run(bakeTo("m.lwc"));
  writeFile(path("camera.json"), R"({"eye": [0.5, 0.1, 0.4], "target": [0, 0, 0], "vertical_fov_deg": 60, "width": 48, "height": 32, "exposure": "auto"})");
  writeFile(path("none.json"), R"({"lights": []})");
  const std::vector<std::string> render{"render", path("m.lwc"), "--camera", path("camera.json"), "-o", path("m.png")};
  run(render);
  EXPECT_GT(readFile(path("m.png")).size(), 100u);
  const auto fails = [&](std::vector<std::string> more) {
    more.insert(more.begin(), render.begin(), render.end());
    const Finished finished = lightwell(more);
    EXPECT_EQ(finished.exit_code, 2);
    return finished.err;
  };
  EXPECT_THAT(fails({"--lights", path("none.json")}), HasSubstr("bake --lights"));
  EXPECT_THAT(fails({"--technique", "prm"}), HasSubstr("no section prm"));
  EXPECT_THAT(fails({"--portal", "door=1"}), HasSubstr("--technique radiosity"));
}

TEST_F(CliLightmapTest, TheBytesDoNotDependOnThreads) {
  for (const char* threads : {"1", "2", "5"}) run(bakeTo(std::string("m") + threads + ".lwc", {"--threads", threads}));
  EXPECT_EQ(readFile(path("m1.lwc")), readFile(path("m2.lwc")));
  EXPECT_EQ(readFile(path("m1.lwc")), readFile(path("m5.lwc")));
}

TEST_F(CliLightmapTest, WhatIsKeptOfAnotherBakeIsOnlyWhatIsTheSame) {
  writeFile(path("lamp.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1, .shutter = true, .shutter_marked = false}));
  run(bakeTo("m.lwc", {"--cache", path("cache")}));
  run(bakeTo("kept.lwc", {"--portal", "shut*", "--cache", path("cache")}));
  run(bakeTo("clean.lwc", {"--portal", "shut*"}));
  EXPECT_EQ(readFile(path("kept.lwc")), readFile(path("clean.lwc")));
}

TEST_F(CliLightmapTest, TheErrorIsMeasuredAndRefinedTo) {
  const auto report = nlohmann::json::parse(run(bakeTo("m.lwc", {"--quality", "preview", "--json"})).out);
  ASSERT_EQ(report["error"].size(), 1u);
  const auto error = report["error"][0];
  EXPECT_EQ(error["section"], "lightmap");
  EXPECT_LE(error["relrmse_interval"][0], error["relrmse"]);
  EXPECT_GE(error["relrmse_interval"][1], error["relrmse"]);
  EXPECT_LT(error["relrmse"], 0.1);
  EXPECT_THAT(run({"info", path("m.lwc")}).out, HasSubstr("measured error of lightmap"));
  run({"verify", path("m.lwc")});
  // A draft is only measured when an error is asked for.
  EXPECT_TRUE(nlohmann::json::parse(run(bakeTo("m.lwc", {"--json"})).out)["error"].is_null());
  const auto refined = nlohmann::json::parse(run(bakeTo("m.lwc", {"--target-error", "0.02", "--json"})).out);
  EXPECT_LE(refined["error"][0]["relrmse"], 0.02);
}

TEST_F(CliLightmapTest, TheClockLeavesADraftAtLeast) {
  const auto cut = nlohmann::json::parse(run(bakeTo("m.lwc", {"--quality", "production", "--time-limit", "0", "--json"})).out);
  EXPECT_EQ(cut["settings"]["quality"], "draft");
  EXPECT_TRUE(cut["time_limited"]);
  run({"verify", path("m.lwc")});
}

TEST_F(CliLightmapTest, ADirectionalMapHasTheSameLight) {
  run(bakeTo("m.lwc"));
  const double flat = evaluate("total");
  run(bakeTo("m.lwc", {"--directional"}));
  run({"verify", path("m.lwc")});
  EXPECT_EQ(evaluate("total"), flat);
  EXPECT_TRUE(nlohmann::json::parse(run({"info", path("m.lwc"), "--json"}).out)["content"]["lightmap"]["has_gradients"]);
  const Finished wrong = lightwell({"bake", path("lamp.gltf"), "-o", path("m.lwc"), "--directional"});
  EXPECT_EQ(wrong.exit_code, 2);
}

TEST_F(CliLightmapTest, ATargetHoldsForVirtualLightsToo) {
  const auto report = nlohmann::json::parse(
      run({"bake", path("lamp.gltf"), "-o", path("v.lwc"), "--techniques", "vpl", "--lightmap-size", "32", "--quality", "draft", "--target-error", "0.5", "--record-seconds", "--json"}).out);
  const auto& error = report["error"][0];
  EXPECT_EQ(error["section"], "vpl");
  EXPECT_LE(error["relrmse"], 0.5);
  EXPECT_LE(error["maximum_interval"][0], error["maximum"]);
  EXPECT_GT(error["seconds"], 0);
  EXPECT_THAT(run({"info", path("v.lwc")}).out, HasSubstr("baked in"));
  run({"verify", path("v.lwc")});
}

}  // namespace
}  // namespace lightwell::test
