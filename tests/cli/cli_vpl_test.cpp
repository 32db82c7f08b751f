// Virtual lights from the scene to the evaluated atlas: a closed room, whose light is known.
#include <gmock/gmock.h>

#include <numbers>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class CliVplTest : public CommandTest {
 protected:
  void SetUp() override { writeFile(path("lamp.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1})); }
  std::vector<std::string> bakeTo(const std::string& file, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"bake", path("lamp.gltf"), "-o", path(file), "--techniques", "vpl", "--lightmap-size", "32", "--quality", "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  double evaluate(const std::string& component) {
    run({"evaluate", path("v.lwc"), "--technique", "vpl", "--component", component, "-o", path("e.exr")});
    return meanOf("e.exr");
  }
};

TEST_F(CliVplTest, AClosedRoomKeepsTheLampsEnergy) {
  run(bakeTo("v.lwc"));
  run({"verify", path("v.lwc")});
  const double direct = 4 * std::numbers::pi / 24, indirect = direct / 0.3 - direct;  // 24 m², albedo 0.7, 1 cd
  EXPECT_NEAR(evaluate("direct") / direct, 1, 0.01);
  EXPECT_NEAR(evaluate("indirect") / indirect, 1, 0.03);
  EXPECT_NEAR(evaluate("total") / (direct + indirect), 1, 0.03);
  EXPECT_THAT(run({"info", path("v.lwc")}).out, HasSubstr("polygons"));
}

TEST_F(CliVplTest, EveryShapeCanBeForcedAndCounted) {
  for (const std::string shape : {"point", "disk", "sphere", "polygon"}) {
    run(bakeTo("v.lwc", {"--virtual-light", shape, "--virtual-lights", "40"}));
    run({"verify", path("v.lwc")});
    EXPECT_THAT(run({"info", path("v.lwc")}).out, HasSubstr("\"" + shape + "s\":40"));
    evaluate("indirect");
  }
}

TEST_F(CliVplTest, ACutGivesWhatAllLightsGive) {
  run(bakeTo("v.lwc", {"--virtual-lights", "600"}));
  const std::vector<std::string> evaluate{"evaluate", path("v.lwc"), "--technique", "vpl", "--component", "indirect", "-o"};
  const auto with = [&](const std::string& file, std::vector<std::string> more) {
    std::vector<std::string> arguments = evaluate;
    arguments.push_back(path(file));
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments).err;
  };
  EXPECT_THAT(with("all.exr", {"--cut-error", "0"}), HasSubstr("600 virtual lights"));
  with("cut.exr", {});
  EXPECT_NEAR(meanOf("cut.exr") / meanOf("all.exr"), 1, 2e-3);
}

TEST_F(CliVplTest, WhatTheClampTakesFromPointsIsRestored) {
  run(bakeTo("v.lwc", {"--virtual-light", "point", "--virtual-lights", "2000"}));  // so many that none stands for a place of its own
  const auto mean = [&](std::vector<std::string> more, bool clamped) {
    std::vector<std::string> arguments{"evaluate", path("v.lwc"), "--technique", "vpl", "--component", "indirect", "-o", path("e.exr")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const std::string said = run(arguments).err;
    EXPECT_EQ(said.find("clamped away") != std::string::npos, clamped) << said;
    return meanOf("e.exr");
  };
  const double exact = (4 * std::numbers::pi / 24) * 0.7 / 0.3;
  mean({"--clamp", "0"}, false);
  const double clamped = mean({"--clamp", "0.5", "--no-restore"}, true), restored = mean({"--clamp", "0.5"}, true);
  EXPECT_LT(clamped / exact, 0.95);
  EXPECT_NEAR(restored / exact, 1, 0.02);
}

TEST_F(CliVplTest, OpenGlDrawsTheSameLight) {
  run(bakeTo("v.lwc"));
  const double indirect = evaluate("indirect");
  const Finished gl = run({"evaluate", path("v.lwc"), "--technique", "vpl", "--evaluator", "gl", "--component", "indirect", "-o", path("e.exr")});
  EXPECT_THAT(gl.out + gl.err, HasSubstr("ms each"));
  EXPECT_NEAR(meanOf("e.exr") / indirect, 1, 0.05) << "texels across an edge of the room have one normal on OpenGL";
}

TEST_F(CliVplTest, SaysWhatItCannotDo) {
  run(bakeTo("v.lwc"));
  const Finished cpu = lightwell({"evaluate", path("v.lwc"), "--technique", "vpl", "--pieces", "2", "-o", path("e.exr")});
  EXPECT_EQ(cpu.exit_code, 2);
  EXPECT_THAT(cpu.err, HasSubstr("--evaluator gl"));
  const Finished alone = lightwell({"bake", path("lamp.gltf"), "-o", path("p.lwc"), "--techniques", "prm", "--virtual-lights", "10"});
  EXPECT_EQ(alone.exit_code, 2);
  EXPECT_THAT(alone.err, HasSubstr("--techniques vpl"));
  writeFile(path("none.json"), R"({"lights": []})");
  run(bakeTo("v.lwc", {"--lights", path("none.json")}));
  EXPECT_THAT(run({"info", path("v.lwc")}).out, HasSubstr("without vpl: nothing shines"));
}

TEST_F(CliVplTest, TheBytesDoNotDependOnThreads) {
  for (const char* threads : {"1", "5"}) run(bakeTo(std::string("v") + threads + ".lwc", {"--threads", threads}));
  EXPECT_EQ(readFile(path("v1.lwc")), readFile(path("v5.lwc")));
}

}  // namespace
}  // namespace lightwell::test
