// Light of lamps that nothing was baked for, from the command line: a closed room, whose first reflection is known.
#include <gmock/gmock.h>

#include <numbers>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using testing::HasSubstr;

class CliDynamicTest : public CommandTest {
 protected:
  void SetUp() override {
    writeFile(path("lamp.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1}));
    run({"bake", path("lamp.gltf"), "-o", path("v.lwc"), "--techniques", "vpl", "--points", "4096", "--lightmap-size", "32", "--quality", "draft"});
  }
};

TEST_F(CliDynamicTest, TheFirstReflectionHasItsEnergy) {
  run({"verify", path("v.lwc")});
  EXPECT_THAT(run({"info", path("v.lwc")}).out, HasSubstr("\"points\":4096"));
  for (const std::string way : {"rsm", "iir"}) {
    run({"evaluate", path("v.lwc"), "--technique", "vpl", "--evaluator", "gl", "--dynamic", way, "--component", "indirect", "-o", path("e.exr")});
    EXPECT_NEAR(meanOf("e.exr") / (4 * std::numbers::pi * 0.7 / 24), 0.97, 0.04) << way;  // 24 m²; corners lose some
  }
}

TEST_F(CliDynamicTest, OtherLampsThanTheBakedOnesShine) {
  writeFile(path("lights.json"), R"({"lights":[{"type":"point","position":[0,0,0],"color":[1,1,1],"intensity":5}]})");
  run({"evaluate", path("v.lwc"), "--technique", "vpl", "--evaluator", "gl", "--dynamic", "rsm", "--lights", path("lights.json"), "--component", "indirect", "-o", path("e.exr")});
  EXPECT_NEAR(meanOf("e.exr") / (5 * 4 * std::numbers::pi * 0.7 / 24), 0.97, 0.04);
}

TEST_F(CliDynamicTest, WhatIsMissingIsSaid) {
  const auto fails = [&](std::vector<std::string> arguments, const std::string& what) {
    arguments.insert(arguments.begin(), {"evaluate", path("v.lwc"), "-o", path("e.exr")});
    const Finished finished = lightwell(arguments);
    EXPECT_EQ(finished.exit_code, 2);
    EXPECT_THAT(finished.err, HasSubstr(what));
  };
  fails({"--technique", "vpl", "--dynamic", "rsm"}, "--dynamic");
  fails({"--technique", "vpl", "--evaluator", "gl", "--dynamic", "best"}, "best");
  fails({"--technique", "vpl", "--evaluator", "gl", "--dynamic", "rsm", "--dynamic-shadows", "33"}, "33");
  run({"bake", path("lamp.gltf"), "-o", path("v.lwc"), "--techniques", "vpl", "--lightmap-size", "32", "--quality", "draft"});
  fails({"--technique", "vpl", "--evaluator", "gl", "--dynamic", "rsm"}, "no section points: not asked for");
  run({"evaluate", path("v.lwc"), "--technique", "vpl", "--evaluator", "gl", "--dynamic", "rsm", "--dynamic-shadows", "0", "-o", path("e.exr")});
}

}  // namespace
}  // namespace lightwell::test
