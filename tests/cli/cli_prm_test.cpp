// The paper's form of the section prm, which the default is measured against: panes, by gathering or by walks, all or the brightest.
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "precompute/core/image.h"
#include "tests/cli/process.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliPrmTest : public FolderTest {
 protected:
  void SetUp() override {
    writeFile(path("lamp.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1}));
  }
  Finished run(const std::vector<std::string>& arguments, int exit_code = 0) {
    const Finished finished = lightwell(arguments);
    EXPECT_EQ(finished.exit_code, exit_code) << arguments[0] << ": " << finished.err;
    return finished;
  }
  Finished bake(const std::string& output, const std::vector<std::string>& more, int exit_code = 0) {
    std::vector<std::string> arguments{"bake", path("lamp.gltf"), "-o", path(output), "--lightmap-size", "24", "--quality", "draft"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments, exit_code);
  }
  ImageRgba evaluate(const std::string& container, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments{"evaluate", path(container), "--technique", "prm", "--component", "indirect", "-o", path("e.exr")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    run(arguments);
    return readExr(path("e.exr"));
  }
};

double mean(const ImageRgba& image) {
  double sum = 0, count = 0;
  for (const auto& p : image.pixels)
    if (p[3] == 1) sum += p[0], ++count;
  return sum / count;
}

double largestDifference(const ImageRgba& a, const ImageRgba& b) {
  double largest = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) largest = std::max(largest, std::abs(double(a.pixels[i][0]) - b.pixels[i][0]));
  return largest;
}

TEST_F(CliPrmTest, PanesOfBothEstimatorsFollowEnergyConservation) {
  const double direct = 4 * std::numbers::pi / 24, indirect = direct / 0.3 - direct;  // a closed room of 24 m², albedo 0.7, 1 cd
  for (const auto& [estimator, tolerance] : {std::pair("gather", 0.03), std::pair("walks", 0.15)}) {
    bake("panes.lwc", {"--prm-layout", "panes", "--prm-estimator", estimator, "--prm-entries", "192", "--prm-clusters", "24"});
    const json info = json::parse(run({"info", path("panes.lwc"), "--json"}).out);
    const json& prm = info["content"]["prm"];
    EXPECT_EQ(prm["layout"], "panes");
    EXPECT_NEAR(prm["clusters"].get<double>(), 24, 6);
    EXPECT_NEAR(prm["entries"].get<double>() / prm["clusters"].get<double>(), 8, 0.5);
    EXPECT_EQ(info["provenance"]["settings"]["prm_estimator"], estimator);
    EXPECT_NEAR(mean(evaluate("panes.lwc")) / indirect, 1, tolerance) << estimator;
  }
}

TEST_F(CliPrmTest, TheBrightestPanesKeepTheEnergyOfAll) {
  bake("panes.lwc", {"--prm-layout", "panes", "--prm-clusters", "96"});
  const ImageRgba all = evaluate("panes.lwc"), brightest = evaluate("panes.lwc", {"--brightest", "8"});
  EXPECT_NEAR(mean(brightest) / mean(all), 1, 1e-3);
  EXPECT_GT(largestDifference(brightest, all), 0.01 * mean(all)) << "8 panes of 96 are not all of them";
  EXPECT_LT(largestDifference(evaluate("panes.lwc", {"--brightest", "8", "--evaluator", "gl"}), brightest), 0.01 * mean(all));
  EXPECT_EQ(largestDifference(evaluate("panes.lwc", {"--brightest", "0"}), all), 0);
}

TEST_F(CliPrmTest, ChoicesThatExcludeEachOtherAreWrongUsage) {
  EXPECT_THAT(bake("o.lwc", {"--prm-estimator", "walks"}, 2).err, HasSubstr("--prm-layout panes"));
  EXPECT_THAT(bake("o.lwc", {"--prm-entries", "10", "--prm-clusters", "11"}, 2).err, HasSubstr("--prm-entries"));
  EXPECT_THAT(bake("o.lwc", {"--prm-layout", "panes", "--prm-clusters", "4097"}, 2).err, HasSubstr("--prm-clusters"));
  EXPECT_FALSE(std::filesystem::exists(path("o.lwc")));
  bake("bases.lwc", {});
  EXPECT_THAT(run({"evaluate", path("bases.lwc"), "--technique", "prm", "--brightest", "8", "-o", path("e.exr")}, 2).err, HasSubstr("--brightest"));
}

}  // namespace
}  // namespace lightwell::test
