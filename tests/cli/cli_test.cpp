// What the command does when all is well: physics of the small rooms, same bytes, valid JSON.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliTest : public CommandTest {
 protected:
  void SetUp() override {
    writeFile(path("lamp.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1}));
    writeFile(path("furnace.gltf"), roomGltf({.albedo = 0.5, .emission = 1}));
    writeFile(path("empty.gltf"), roomGltf({.surfaces = false}));
  }
  void bake(const std::string& scene, const std::string& output, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments{"bake", path(scene), "-o", path(output), "--lightmap-size", "24", "--quality", "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
  }
};

TEST_F(CliTest, SameBytesForAnyNumberOfThreads) {
  bake("lamp.gltf", "1.lwc", {"--threads", "1"});
  const std::string bytes = readFile(path("1.lwc"));
  ASSERT_FALSE(bytes.empty());
  for (const char* threads : {"2", "5"}) {
    bake("lamp.gltf", "n.lwc", {"--threads", threads});
    EXPECT_TRUE(readFile(path("n.lwc")) == bytes) << threads << " threads";
  }
  bake("lamp.gltf", "n.lwc", {"--seed", "2"});
  EXPECT_FALSE(readFile(path("n.lwc")) == bytes) << "another seed must matter";
}

TEST_F(CliTest, BakeReportsAndContainerIsSound) {
  const json report =
      runJson({"bake", path("furnace.gltf"), "-o", path("o.lwc"), "--lightmap-size", "24", "--quality", "draft", "--json"}, "bake");
  EXPECT_GT(report["rays"], 0);
  EXPECT_EQ(report["bytes"], std::filesystem::file_size(path("o.lwc")));
  std::vector<std::string> types;
  for (const auto& section : report["sections"]) types.push_back(section["type"]);
  EXPECT_THAT(types, testing::ElementsAre("meta", "scene", "geometry", "atlas", "prm"));
  double phase_seconds = 0;
  for (const auto& phase : report["phases"]) phase_seconds += phase["seconds"].get<double>();
  EXPECT_LE(phase_seconds, report["seconds"].get<double>() * 1.001);

  EXPECT_TRUE(runJson({"verify", path("o.lwc"), "--json"}, "verify")["sound"]);
  const json info = runJson({"info", path("o.lwc"), "--json"}, "info");
  EXPECT_EQ(info["content"]["atlas"]["width"], 24);
  EXPECT_EQ(info["provenance"]["scene_name"], "furnace.gltf");
  EXPECT_EQ(info["provenance"]["settings"]["quality"], "draft");
  EXPECT_TRUE(info["content"]["prm"]["has_emitter"]);
  EXPECT_THAT(run({"info", path("o.lwc")}).out, HasSubstr("without vpl"));
}

// Closed room, every wall emits radiance 1 and reflects half: E = π + E/2 = 2π; direct π, indirect π.
TEST_F(CliTest, FurnaceIsRightFromContainerAndReference) {
  bake("furnace.gltf", "o.lwc");
  for (const auto& [component, expected] : {std::pair("direct", 1.0), std::pair("indirect", 1.0), std::pair("total", 2.0)}) {
    run({"evaluate", path("o.lwc"), "--technique", "prm", "--evaluator", "cpu", "--component", component, "-o", path("e.exr")});
    EXPECT_NEAR(meanOf("e.exr") / std::numbers::pi, expected, 0.02) << component;
    run({"reference", path("furnace.gltf"), "--component", component, "--lightmap-size", "24", "--samples", "64", "-o", path("r.exr")});
    EXPECT_NEAR(meanOf("r.exr") / std::numbers::pi, expected, 0.01) << component;
  }
}

// A lamp of 1 cd in a closed cube of area A = 24 m² and albedo ρ = 0.7: mean direct 4π/A, mean total 4π/A/(1 − ρ).
TEST_F(CliTest, LampInClosedRoomFollowsEnergyConservation) {
  const double direct = 4 * std::numbers::pi / 24;
  run({"reference", path("lamp.gltf"), "--component", "total", "--lightmap-size", "24", "--samples", "64", "-o", path("r.exr")});
  EXPECT_NEAR(meanOf("r.exr"), direct / 0.3, 0.02 * direct / 0.3);
  bake("lamp.gltf", "o.lwc");
  run({"evaluate", path("o.lwc"), "--technique", "prm", "--component", "total", "-o", path("e.exr")});
  EXPECT_NEAR(meanOf("e.exr"), direct / 0.3, 0.03 * direct / 0.3);
  const json errors = runJson({"compare", path("r.exr"), path("e.exr"), "--json"}, "compare");
  EXPECT_LT(errors["relrmse"], 0.1);
  EXPECT_EQ(errors["missing"], 0);

  // Lights replaced: twice the intensity, twice the light, on both evaluators.
  writeFile(path("two.json"), R"({"lights":[{"type":"point","position":[0,0,0],"color":[1,1,1],"intensity":2}]})");
  run({"evaluate", path("o.lwc"), "--technique", "prm", "--component", "total", "--lights", path("two.json"), "-o", path("e2.exr")});
  EXPECT_NEAR(meanOf("e2.exr") / meanOf("e.exr"), 2, 1e-3);
  run({"evaluate", path("o.lwc"), "--technique", "prm", "--evaluator", "gl", "--component", "indirect", "--lights", path("two.json"), "-o",
       path("gl.exr")});
  run({"evaluate", path("o.lwc"), "--technique", "prm", "--evaluator", "cpu", "--component", "indirect", "--lights", path("two.json"), "-o",
       path("cpu.exr")});
  EXPECT_LT(runJson({"compare", path("cpu.exr"), path("gl.exr"), "--json"}, "compare")["relrmse"], 0.002);
}

TEST_F(CliTest, StandardErrorTellsTheNoise) {
  const auto noise = [&](const char* samples) {
    run({"reference", path("furnace.gltf"), "--component", "indirect", "--lightmap-size", "12", "--samples", samples, "-o", path("r.exr"),
         "--standard-error", path("se.exr")});
    return meanOf("se.exr");
  };
  const double few = noise("16"), many = noise("256");
  EXPECT_GT(few, 0);
  EXPECT_LT(many, few / 2);
}

TEST_F(CliTest, CacheReusesWhatHasNotChanged) {
  bake("lamp.gltf", "plain.lwc");
  bake("lamp.gltf", "first.lwc", {"--cache", path("cache")});
  EXPECT_TRUE(readFile(path("first.lwc")) == readFile(path("plain.lwc")));
  const auto again = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"bake", path("lamp.gltf"), "-o", path("again.lwc"), "--lightmap-size", "24", "--quality", "draft",
                                       "--cache", path("cache"), "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runJson(arguments, "bake");
  };
  const json same = again({});
  EXPECT_EQ(same["tasks_run"], 0);
  EXPECT_TRUE(readFile(path("again.lwc")) == readFile(path("plain.lwc")));
  writeFile(path("other.json"), R"({"lights":[{"type":"directional","direction":[0,-1,0],"intensity":3}]})");
  EXPECT_EQ(again({"--lights", path("other.json")})["tasks_run"], 1) << "lights change the container, not the transport";
  EXPECT_GT(again({"--seed", "5"})["tasks_run"], 3);
}

TEST_F(CliTest, LimitsAreKept) {
  const auto bakeWith = [&](const std::vector<std::string>& limits) {
    std::vector<std::string> arguments{"bake", path("lamp.gltf"), "-o", path("o.lwc"), "--lightmap-size", "24", "--json"};
    arguments.insert(arguments.end(), limits.begin(), limits.end());
    return runJson(arguments, "bake");
  };
  const json free = bakeWith({"--quality", "draft"});
  EXPECT_FALSE(free["time_limited"]);
  const uint64_t limit = free["bytes"].get<uint64_t>() * 19 / 20;  // most of so small a container is not transport
  const json small = bakeWith({"--quality", "draft", "--size-limit", std::to_string(limit)});
  EXPECT_LE(small["bytes"], limit);
  EXPECT_LT(small["settings"]["refinement"], 0);

  const json hasty = bakeWith({"--quality", "production", "--time-limit", "0"});
  EXPECT_TRUE(hasty["time_limited"]);
  EXPECT_EQ(hasty["settings"]["quality"], "draft");
  EXPECT_TRUE(runJson({"info", path("o.lwc"), "--json"}, "info")["provenance"]["time_limited"]);

  const json measured = bakeWith({"--quality", "draft", "--target-error", "9"});
  EXPECT_EQ(measured["settings"]["refinement"], 0) << "nothing to refine";
  EXPECT_LT(measured["error"][0]["relrmse"], 9);
}

TEST_F(CliTest, SceneWithoutSurfacesIsAValidContainer) {
  const json report = runJson({"bake", path("empty.gltf"), "-o", path("o.lwc"), "--json"}, "bake");
  std::vector<std::string> omitted;
  for (const auto& o : report["omitted"]) omitted.push_back(o["type"]);
  EXPECT_THAT(omitted, testing::IsSupersetOf({"geometry", "atlas", "prm"}));
  run({"verify", path("o.lwc")});
  run({"reference", path("empty.gltf"), "--lightmap-size", "8", "-o", path("r.exr")});
  EXPECT_EQ(readExr(path("r.exr")).width, 8);
}

TEST_F(CliTest, RenderWritesAPicture) {
  bake("lamp.gltf", "o.lwc");
  writeFile(path("cam.json"), R"({"eye":[0,0,0.9],"target":[0,0,-1],"width":64,"height":48})");
  run({"render", path("o.lwc"), "--camera", path("cam.json"), "-o", path("o.png")});
  EXPECT_EQ(readFile(path("o.png")).substr(1, 3), "PNG");
}

TEST_F(CliTest, HelpTeachesAndVersionIsTold) {
  EXPECT_THAT(run({"--version"}).out, testing::MatchesRegex("lightwell [0-9]+\\.[0-9]+\\.[0-9]+\n"));
  const std::string help = run({"--help"}).out;
  for (const char* command : {"bake", "info", "verify", "evaluate", "reference", "compare", "render"}) {
    EXPECT_THAT(help, HasSubstr(command));
    EXPECT_THAT(run({command, "--help"}).out, HasSubstr("Example")) << command;
  }
}

}  // namespace
}  // namespace lightwell::test
