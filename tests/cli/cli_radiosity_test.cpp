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

}  // namespace
}  // namespace lightwell::test
