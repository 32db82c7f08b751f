// lightwell report: what it leaves behind, what its figures are, what it does not measure twice.
#include <gmock/gmock.h>

#include <csignal>
#include <sstream>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class CliReportTest : public CommandTest {
 protected:
  void SetUp() override { writeFile(path("room.gltf"), roomGltf({.albedo = 0.6, .lamp_candela = 10, .boxes = true})); }
  std::vector<std::string> arguments(const std::vector<std::string>& more = {}) {
    std::vector<std::string> all{"report", path("room.gltf"), "-o", path("r"), "--lightmap-size", "24", "--reference-samples", "32"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// report.json, which must keep to its schema.
  json report() {
    const json document = json::parse(readFile(path("r/report.json")), nullptr, false);
    EXPECT_EQ(schemaViolation(readSchema("report"), document), "");
    return document;
  }
  const json& bakeOf(const json& document, const std::string& series) {
    for (const json& bake : document["bakes"])
      if (bake["series"] == series) return bake;
    ADD_FAILURE() << "no bake of " << series;
    return document["bakes"][0];
  }
};

// One run serves several questions: bakes take seconds.
TEST_F(CliReportTest, WritesAPageWhoseFiguresAreThoseOfCompareByHand) {
  run(arguments({"--budget", "20"}));
  const json document = report();
  for (const char* file : {"report.html", "report.csv", "error_by_bake_seconds.svg", "error_by_bytes.svg", "bake_phases.svg", "error_by_frame_ms_cpu.svg", "pictures/reference.png"})
    EXPECT_TRUE(std::filesystem::is_regular_file(folder_ / "r" / file)) << file;
  const std::string page = readFile(path("r/report.html"));
  for (const char* word : {"<svg", "data:image/png;base64,", "In short", "lightwell bake "}) EXPECT_THAT(page, HasSubstr(word));
  for (const char* outside : {"src=\"http", "href=\"http", "@import", "<script", "<link", "url("}) EXPECT_THAT(page, Not(HasSubstr(outside)));
  const std::string csv = readFile(path("r/report.csv"));
  size_t evaluations = 0;
  for (const json& bake : document["bakes"]) evaluations += bake["evaluations"].size();
  EXPECT_EQ(size_t(std::count(csv.begin(), csv.end(), '\n')), evaluations + 1);

  // By the maps that it left,
  for (const json& bake : document["bakes"])
    for (const json& one : bake["evaluations"]) {
      const json compared = runJson({"compare", path("r/maps/reference_a.exr"), path("r/" + one["map"].get<std::string>()), "--second-reference", path("r/maps/reference_b.exr"), "--json"}, "compare");
      for (const char* figure : {"relrmse", "texrel", "bias", "p99", "max", "texels"}) EXPECT_EQ(compared[figure], one[figure]) << bake["series"] << " " << figure;
    }
  // and by the commands that it names, from the scene on.
  for (const char* series : {"prm", "lightmap"}) {
    const json& bake = bakeOf(document, series);
    run({"bake", path("room.gltf"), "--techniques", series, "--quality", bake["setting"], "--lightmap-size", "24", "-o", path("hand.lwc")});
    run({"evaluate", path("hand.lwc"), "--technique", series, "--component", "indirect", "-o", path("hand.exr")});
    EXPECT_THAT(bake["command"].get<std::string>(), HasSubstr(" --techniques " + std::string(series) + " --quality " + bake["setting"].get<std::string>()));
    for (const char* seed : {"1001", "1002"})
      run({"reference", path("room.gltf"), "--component", "indirect", "--lightmap-size", "24", "--samples", "32", "--seed", seed, "-o", path(std::string("hand") + seed + ".exr")});
    const json compared = runJson({"compare", path("hand1001.exr"), path("hand.exr"), "--second-reference", path("hand1002.exr"), "--json"}, "compare");
    for (const char* figure : {"relrmse", "texrel", "bias"}) EXPECT_NEAR(compared[figure].get<double>(), bake["evaluations"][0][figure].get<double>(), 1e-9) << series << " " << figure;
  }

  // Again: nothing that was measured is measured again, whatever its clock said.
  const Finished again = run(arguments({"--budget", "0.1"}));
  const json second = report();
  EXPECT_EQ(second["measured"], 0) << again.err;
  EXPECT_EQ(second["reused"], document["bakes"].size());
  EXPECT_EQ(second["bakes"], document["bakes"]);
  EXPECT_EQ(second["reference"], document["reference"]);
  // Another scene: nothing of the first one counts.
  writeFile(path("room.gltf"), roomGltf({.albedo = 0.5, .lamp_candela = 10, .boxes = true}));
  run(arguments({"--budget", "0.1"}));
  EXPECT_EQ(report()["reused"], 0);
}

TEST_F(CliReportTest, LeavesOutWhatTheBudgetDoesNotHoldAndNamesIt) {
  run(arguments({"--budget", "0.1"}));
  const json nothing = report();
  EXPECT_EQ(nothing["measured"], 0);
  EXPECT_EQ(nothing["bakes"].size(), 0u);
  EXPECT_GT(nothing["skipped"].size(), 10u);
  for (const json& one : nothing["skipped"]) EXPECT_THAT(one["reason"].get<std::string>(), testing::AnyOf(HasSubstr("budget"), HasSubstr("none"), HasSubstr("sky"))) << one;
  EXPECT_THAT(readFile(path("r/report.html")), HasSubstr("No bake ended within the budget"));
}

TEST_F(CliReportTest, MeasuresContainersThatAreGiven) {
  run({"bake", path("room.gltf"), "--techniques", "lightmap,prm", "--quality", "draft", "--lightmap-size", "24", "-o", path("mine.lwc")});
  run(arguments({"--budget", "0.1", "--against", path("mine.lwc")}));
  const json document = report();
  ASSERT_EQ(document["bakes"].size(), 2u);
  for (const json& bake : document["bakes"]) {
    EXPECT_EQ(bake["series"], "given");
    EXPECT_LT(bake["evaluations"][0]["relrmse"].get<double>(), 0.3) << bake["setting"];
    EXPECT_EQ(bake["container_bytes"], std::filesystem::file_size(folder_ / "mine.lwc"));
  }
  run({"bake", path("room.gltf"), "--techniques", "lightmap", "--quality", "draft", "--lightmap-size", "16", "-o", path("other.lwc")});
  const Finished other = lightwell(arguments({"--budget", "0.1", "--against", path("other.lwc")}));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("--lightmap-size"));
}

TEST_F(CliReportTest, PutsLampsWhereNothingShines) {
  writeFile(path("room.gltf"), roomGltf({.albedo = 0.6}));
  run(arguments({"--budget", "0.1"}));
  const json document = report();
  EXPECT_EQ(document["lamps"], 3);
  EXPECT_THAT(document["made_lights"].get<std::string>(), HasSubstr("lights.json"));
  EXPECT_GT(document["reference"]["mean_irradiance"].get<double>(), 0);
  EXPECT_EQ(json::parse(readFile(path("r/lights.json")))["lights"].size(), 3u);
}

TEST_F(CliReportTest, StopsCleanlyAndGoesOnFromThere) {
  Background first(arguments({"--budget", "300"}));
  ASSERT_TRUE(first.waitFor([&] { return std::filesystem::exists(folder_ / "r/finished.json") && readFile(path("r/finished.json")).find("\"series\"") != std::string::npos; })) << first.errors();
  first.signal(SIGINT);
  EXPECT_EQ(first.wait().exit_code, 130);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "r/report.html"));
  run(arguments({"--budget", "0.1"}));
  const json document = report();
  EXPECT_EQ(document["measured"], 0);
  EXPECT_GE(document["reused"].get<int>(), 1);
}

TEST_F(CliReportTest, RefusesWhatCannotBeMeant) {
  EXPECT_EQ(lightwell({"report", path("none.glb"), "-o", path("r")}).exit_code, 3);
  EXPECT_EQ(lightwell({"report", path("room.gltf")}).exit_code, 2);
  EXPECT_EQ(lightwell(arguments({"--budget", "-1"})).exit_code, 2);
  writeFile(path("file"), "");
  EXPECT_EQ(lightwell({"report", path("room.gltf"), "-o", path("file")}).exit_code, 2);
  EXPECT_EQ(lightwell(arguments({"--budget", "0.1", "--against", path("room.gltf")})).exit_code, 4);
  writeFile(path("empty.gltf"), roomGltf({.surfaces = false}));
  const Finished empty = lightwell({"report", path("empty.gltf"), "-o", path("r")});
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err, HasSubstr("has no surfaces"));
}

}  // namespace
}  // namespace lightwell::test
