// Skies from the command: a map alone, queries, a scene under a sky.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;
constexpr double kPi = std::numbers::pi;

/// A Radiance picture of 16 × 8 texels: radiance `above` and `below` the horizon.
std::string skyHdr(float above, float below) {
  std::string text = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n";
  for (int texel = 0; texel < 128; ++texel) {
    int exponent = 0;
    const float mantissa = std::frexp(texel < 64 ? above : below, &exponent);
    for (int c = 0; c < 3; ++c) text += char(mantissa * 256);
    text += mantissa > 0 ? char(exponent + 128) : '\0';
  }
  return text;
}

class CliEnvironmentTest : public CommandTest {
 protected:
  void SetUp() override {
    writeFile(path("sky.hdr"), skyHdr(1, 1));
    writeFile(path("day.hdr"), skyHdr(4, 0.5f));
    writeFile(path("black.hdr"), skyHdr(0, 0));
    writeFile(path("q.json"), R"({"queries":[{"normal":[0,3,0]},{"mirror":[0,-1,0],"shininess":100},{"normal":[0,-1,0]}]})");
    writeFile(path("closed.gltf"), roomGltf({.albedo = 0.5}));
    writeFile(path("open.gltf"), roomGltf({.albedo = 0.5, .open = true}));
  }
  void expectFailure(const std::vector<std::string>& arguments, int exit_code, const std::string& message) {
    const Finished finished = lightwell(arguments);
    EXPECT_EQ(finished.exit_code, exit_code) << finished.err;
    EXPECT_THAT(finished.err, HasSubstr(message));
    EXPECT_EQ(finished.out, "");
  }
};

TEST_F(CliEnvironmentTest, ASkyAloneIsAContainerThatAnswers) {
  const json report = runJson({"bake", "--environment", path("sky.hdr"), "--environment-samples", "16", "-o", path("o.lwc"), "--json"}, "bake");
  std::vector<std::string> sections, omitted;
  for (const auto& s : report["sections"]) sections.push_back(s["type"]);
  for (const auto& o : report["omitted"]) omitted.push_back(o["type"]);
  EXPECT_THAT(sections, ElementsAre("meta", "environment"));
  EXPECT_THAT(omitted, testing::IsSupersetOf({"scene", "geometry", "atlas", "prm"}));
  EXPECT_EQ(report["error"][0]["section"], "environment");
  EXPECT_LT(report["error"][0]["relrmse"], 0.01);  // of quadrature over 16 × 8 texels
  run({"verify", path("o.lwc")});
  const json info = runJson({"info", path("o.lwc"), "--json"}, "info");
  EXPECT_EQ(info["content"]["environment"]["cells"], 16);
  EXPECT_EQ(info["provenance"]["environment_name"], "sky.hdr");
  EXPECT_THAT(run({"info", path("o.lwc")}).out, HasSubstr("baked from sky.hdr"));

  const json answers =
      runJson({"environment", path("o.lwc"), "--queries", path("q.json"), "--exact", path("sky.hdr"), "--json"}, "environment")["answers"];
  EXPECT_EQ(schemaViolation(readSchema("queries"), json::parse(readFile(path("q.json")))), "");
  ASSERT_EQ(answers.size(), 3u);
  const double exact[] = {kPi, 2 * kPi / 101, kPi};
  for (size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(answers[i]["value"][1].get<double>() / exact[i], 1, 2e-4) << i;
    EXPECT_NEAR(answers[i]["exact"][1].get<double>() / exact[i], 1, 0.01) << i;
  }
  EXPECT_FALSE(runJson({"environment", path("o.lwc"), "--queries", path("q.json"), "--json"}, "environment")["answers"][0].contains("exact"));
}

TEST_F(CliEnvironmentTest, ThePlacementHoldsForExactAnswersToo) {
  run({"bake", "--environment", path("day.hdr"), "--environment-intensity", "2", "--environment-ground", "0", "0", "0",
       "--environment-rotation", "30", "-o", path("o.lwc")});
  const json answers =
      runJson({"environment", path("o.lwc"), "--queries", path("q.json"), "--exact", path("day.hdr"), "--json"}, "environment")["answers"];
  for (const char* key : {"value", "exact"}) {
    EXPECT_NEAR(answers[0][key][0].get<double>() / (8 * kPi), 1, 0.01) << key;
    EXPECT_NEAR(answers[2][key][0].get<double>(), 0, 0.05) << key;
  }
}

TEST_F(CliEnvironmentTest, SameBytesForAnyNumberOfThreads) {
  std::string bytes;
  for (const char* threads : {"1", "3"}) {
    run({"bake", path("open.gltf"), "--environment", path("day.hdr"), "--lightmap-size", "24", "--quality", "draft", "--threads", threads, "-o",
         path("o.lwc")});
    if (bytes.empty()) bytes = readFile(path("o.lwc"));
    EXPECT_TRUE(readFile(path("o.lwc")) == bytes) << threads;
  }
}

/// The opening of a box is an emitter of radiance L: what a black lid would receive, 4 πL m², is spread over the walls.
TEST_F(CliEnvironmentTest, AnOpenRoomIsLitAndAClosedOneIsNot) {
  for (const char* scene : {"open", "closed"}) {
    const std::string file = path(std::string(scene) + ".gltf");
    run({"bake", file, "--environment", path("sky.hdr"), "--techniques", "prm", "--lightmap-size", "24", "--quality", "preview", "--keep-all",
         "-o", path("o.lwc")});
    run({"verify", path("o.lwc")});
    EXPECT_TRUE(runJson({"info", path("o.lwc"), "--json"}, "info")["content"]["prm"]["has_sky"]);
    for (const std::string component : {"direct", "indirect", "total"}) {
      run({"reference", file, "--environment", path("sky.hdr"), "--component", component, "--lightmap-size", "24", "--samples", "256", "-o",
           path("r.exr")});
      const double truth = meanOf("r.exr");
      if (scene == std::string("closed")) {
        EXPECT_EQ(truth, 0);
      } else if (component == "direct") {
        EXPECT_NEAR(truth, 4 * kPi / 20, 0.02 * truth);
      }
      for (const char* evaluator : {"cpu", "gl"}) {
        run({"evaluate", path("o.lwc"), "--technique", "prm", "--evaluator", evaluator, "--component", component, "-o", path("e.exr")});
        EXPECT_NEAR(meanOf("e.exr"), truth, 0.03 * truth) << scene << " " << component << " " << evaluator;
      }
    }
  }
}

/// The cells' light on surfaces, by rays and by depth maps, is what paths find.
TEST_F(CliEnvironmentTest, CellsLightAnOpenRoomAsPathsDo) {
  run({"bake", path("open.gltf"), "--environment", path("day.hdr"), "--lightmap-size", "24", "--quality", "draft", "-o", path("o.lwc")});
  for (const std::string component : {"direct", "total"}) {
    run({"reference", path("open.gltf"), "--environment", path("day.hdr"), "--component", component, "--lightmap-size", "24", "--samples", "256", "-o",
         path("r.exr")});
    const double truth = meanOf("r.exr");
    for (const char* evaluator : {"cpu", "gl"}) {
      run({"evaluate", path("o.lwc"), "--technique", "environment", "--evaluator", evaluator, "--component", component, "--samples", "8", "-o",
           path("e.exr")});
      EXPECT_NEAR(meanOf("e.exr"), truth, 0.04 * truth) << component << " " << evaluator;
    }
  }
  run({"bake", "--environment", path("sky.hdr"), "--environment-samples", "16", "-o", path("s.lwc")});
  expectFailure({"evaluate", path("s.lwc"), "--technique", "environment", "-o", path("e.exr")}, 2, "no section geometry");
}

TEST_F(CliEnvironmentTest, ABlackSkyIsLeftOut) {
  const json report = runJson({"bake", path("open.gltf"), "--environment", path("black.hdr"), "--lightmap-size", "16", "--quality", "draft", "-o",
                               path("o.lwc"), "--json"}, "bake");
  for (const auto& o : report["omitted"])
    if (o["type"] == "environment" || o["type"] == "prm.sky") {
      EXPECT_EQ(o["reason"], "the environment map is black");
    }
  for (const auto& s : report["sections"]) EXPECT_NE(s["type"], "environment");
}

TEST_F(CliEnvironmentTest, WrongUsageIs2) {
  const std::string out = path("o.lwc"), sky = path("sky.hdr");
  expectFailure({"bake", "-o", out}, 2, "nothing to bake");
  expectFailure({"bake", path("open.gltf"), "--techniques", "environment", "-o", out}, 2, "--environment FILE");
  expectFailure({"bake", "--environment", sky, "--lights", path("q.json"), "-o", out}, 2, "--lights");
  expectFailure({"bake", "--environment", sky, "--environment-samples", "0", "-o", out}, 2, "--environment-samples");
  expectFailure({"bake", "--environment", sky, "--environment-resolution", "65", "-o", out}, 2, "even");
  expectFailure({"bake", "--environment", sky, "--environment-intensity", "-1", "-o", out}, 2, "--environment-intensity");
  run({"bake", path("closed.gltf"), "--lightmap-size", "16", "--quality", "draft", "-o", out});
  expectFailure({"environment", out, "--queries", path("q.json")}, 2, "no section environment");
}

TEST_F(CliEnvironmentTest, BadMapsAndQueriesAreRejected) {
  const std::string out = path("o.lwc");
  expectFailure({"bake", "--environment", path("missing.hdr"), "-o", out}, 3, "no such file");
  writeFile(path("cut.hdr"), skyHdr(1, 1).substr(0, 300));
  expectFailure({"bake", "--environment", path("cut.hdr"), "-o", out}, 3, "scan line");
  writeFile(path("text.hdr"), "not a picture");
  expectFailure({"bake", "--environment", path("text.hdr"), "-o", out}, 3, "neither a Radiance");
  run({"bake", "--environment", path("sky.hdr"), "--quality", "draft", "-o", out});
  const std::pair<const char*, const char*> cases[] = {
      {"", "q.json"},
      {"[1,", "q.json"},
      {R"([])", "q.json"},
      {R"({})", "queries"},
      {R"({"queries":3})", "queries"},
      {R"({"queries":[],"more":1})", "more"},
      {R"({"queries":[5]})", "queries[0]"},
      {R"({"queries":[{}]})", "queries[0]"},
      {R"({"queries":[{"normal":[0,1,0]},{"normal":[0,1]}]})", "queries[1].normal"},
      {R"({"queries":[{"normal":[0,0,0]}]})", "queries[0].normal"},
      {R"({"queries":[{"normal":["x",0,0]}]})", "queries[0].normal"},
      {R"({"queries":[{"normal":[1e999,0,0]}]})", "q.json"},
      {R"({"queries":[{"normal":[0,1,0],"mirror":[0,1,0],"shininess":2}]})", "queries[0]"},
      {R"({"queries":[{"normal":[0,1,0],"shininess":2}]})", "queries[0].shininess"},
      {R"({"queries":[{"mirror":[0,1,0]}]})", "queries[0]"},
      {R"({"queries":[{"mirror":[0,1,0],"shininess":0.5}]})", "queries[0].shininess"},
      {R"({"queries":[{"mirror":[0,1,0],"shininess":1e9}]})", "queries[0].shininess"},
      {R"({"queries":[{"normal":[0,1,0],"lobe":2}]})", "queries[0].lobe"}};
  for (const auto& [text, place] : cases) {
    SCOPED_TRACE(text);
    writeFile(path("q.json"), text);
    expectFailure({"environment", out, "--queries", path("q.json")}, 3, place);
  }
  std::string many = R"({"queries":[0)";
  for (int i = 0; i < 1 << 20; ++i) many += ",0";
  writeFile(path("q.json"), many + "]}");
  expectFailure({"environment", out, "--queries", path("q.json")}, 3, "has more than 1048576 queries");
  writeFile(path("q.json"), std::string(100000, '['));
  expectFailure({"environment", out, "--queries", path("q.json")}, 3, "q.json");
}

}  // namespace
}  // namespace lightwell::test
