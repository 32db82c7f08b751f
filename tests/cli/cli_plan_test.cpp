// What the plan leaves out, from the command: a closed room under a sky, lights that stay, a game with its own surfaces.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "tests/cli/command_fixture.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CliPlanTest : public CommandTest {
 protected:
  void SetUp() override {
    writeFile(path("closed.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1}));
    writeFile(path("open.gltf"), roomGltf({.albedo = 0.7, .lamp_candela = 1, .open = true}));
    // Eight rows of sixteen white pixels, not compressed.
    std::string sky = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n";
    for (int i = 0; i < 8 * 16; ++i) sky += "\x80\x80\x80\x81";
    writeFile(path("sky.hdr"), sky);
  }
  json bake(const std::string& scene, const std::vector<std::string>& more, const std::string& quality = "draft") {
    std::vector<std::string> arguments{"bake", path(scene), "-o", path("o.lwc"), "--lightmap-size", "24", "--quality", quality, "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return runJson(arguments, "bake");
  }
  bool has(const std::string& section) {
    const json info = runJson({"info", path("o.lwc"), "--json"}, "info");
    return std::any_of(info["sections"].begin(), info["sections"].end(), [&](const json& s) { return s["type"] == section; });
  }
};

TEST_F(CliPlanTest, ASkyThatNothingSeesIsLeftOutWithWhatItSaves) {
  bake("open.gltf", {"--environment", path("sky.hdr")});
  EXPECT_TRUE(has("environment"));
  const json report = bake("closed.gltf", {"--environment", path("sky.hdr")});
  EXPECT_FALSE(has("environment"));
  for (const json& o : report["omitted"])
    if (o["type"] == "environment" || o["type"] == "prm.sky") {
      EXPECT_THAT(o["reason"].get<std::string>(), HasSubstr("no surface sees the sky"));
      EXPECT_GT(o["decoded_bytes"], 1000);
    }
  EXPECT_THAT(run({"info", path("o.lwc")}).out, HasSubstr("without environment: no surface sees the sky"));
  const json everything = bake("closed.gltf", {"--environment", path("sky.hdr"), "--keep-all"});
  EXPECT_TRUE(has("environment"));
  EXPECT_GT(everything["bytes"], report["bytes"]);
  EXPECT_GT(everything["rays"], report["rays"]);
}

TEST_F(CliPlanTest, EntryPointsThatNoTexelTellsApartAreOne) {
  const auto omits = [](const json& report) {
    return std::any_of(report["omitted"].begin(), report["omitted"].end(), [](const json& o) { return o["type"] == "prm.unlinked" && o["decoded_bytes"] > 0; });
  };
  const auto clusters = [&] { return runJson({"info", path("o.lwc"), "--json"}, "info")["content"]["prm"]["clusters"].get<int>(); };
  EXPECT_FALSE(omits(bake("closed.gltf", {"--techniques", "prm", "--keep-all"})));
  const int all = clusters();
  bake("closed.gltf", {"--techniques", "prm"});
  EXPECT_THAT(run({"info", path("o.lwc")}).out, HasSubstr("without prm.unlinked: what tells"));
  EXPECT_LT(clusters(), all);
}

TEST_F(CliPlanTest, TexelsAreAsSmallAsTheErrorAsks) {
  const auto sizeFor = [&](const char* error) {
    const Finished result = run({"bake", path("closed.gltf"), "-o", path("o.lwc"), "--quality", "draft", "--techniques", "lightmap", "--lightmap-size-by-error", "--target-error", error});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out + result.err, HasSubstr("inside of them indirect light varies by"));
    return runJson({"info", path("o.lwc"), "--json"}, "info")["content"]["atlas"]["width"].get<int>();
  };
  const int coarse = sizeFor("0.4"), fine = sizeFor("0.1");
  EXPECT_GE(coarse, 16);
  EXPECT_GE(fine, 2 * coarse);
  EXPECT_EQ(lightwell({"bake", path("closed.gltf"), "-o", path("o.lwc"), "--lightmap-size-by-error"}).exit_code, 2) << "which error?";
  EXPECT_EQ(lightwell({"bake", path("closed.gltf"), "-o", path("o.lwc"), "--lightmap-size-by-error", "--lightmap-size", "64", "--target-error", "0.1"}).exit_code, 2);
}

TEST_F(CliPlanTest, LightsThatStayNeedOnlyALightMap) {
  bake("closed.gltf", {"--moving-lights", "none"});
  EXPECT_TRUE(has("lightmap"));
  EXPECT_FALSE(has("prm"));
}

TEST_F(CliPlanTest, RadianceMapsFitTheLightsThatMove) {
  writeFile(path("paths.json"), R"({"paths": [[[-0.5, 0.2, 0], [0.5, 0.2, 0]], [[0, 0.5, 0.5]]]})");
  for (const std::string lights : {"ceilings", "sun", "lamps"}) {
    bake(lights == "sun" ? "open.gltf" : "closed.gltf", {"--moving-lights", lights});
    EXPECT_TRUE(has("prm")) << lights;
  }
  const json error = bake("closed.gltf", {"--moving-lights", path("paths.json")}, "preview")["error"][0];
  EXPECT_LT(error["relrmse"], 0.1);
  EXPECT_THAT(error["against"].get<std::string>(), HasSubstr("on the given paths"));
  writeFile(path("dark.gltf"), roomGltf({.albedo = 0.7}));
  EXPECT_EQ(lightwell({"bake", path("open.gltf"), "--moving-lights", "ceilings", "-o", path("o.lwc")}).exit_code, 2) << "there is no ceiling";
  EXPECT_EQ(lightwell({"bake", path("dark.gltf"), "--moving-lights", "lamps", "-o", path("o.lwc")}).exit_code, 2) << "there are none";
  EXPECT_NE(lightwell({"bake", path("dark.gltf"), "--moving-lights", path("absent.json"), "-o", path("o.lwc")}).exit_code, 0);
  writeFile(path("bad.json"), R"({"paths": [[]]})");
  const Finished bad = lightwell({"bake", path("dark.gltf"), "--moving-lights", path("bad.json"), "-o", path("o.lwc")});
  EXPECT_EQ(bad.exit_code, 3);
  EXPECT_THAT(bad.err, HasSubstr("paths[0]"));
}

TEST_F(CliPlanTest, AGameWithItsOwnSurfacesNeedsNoGeometry) {
  bake("closed.gltf", {"--no-geometry"});
  EXPECT_FALSE(has("geometry"));
  run({"verify", path("o.lwc")});
  const Finished evaluated = lightwell({"evaluate", path("o.lwc"), "--technique", "prm", "-o", path("e.exr")});
  EXPECT_EQ(evaluated.exit_code, 2);
  EXPECT_THAT(evaluated.err, HasSubstr("the game has its own"));
  writeFile(path("camera.json"), R"({"eye": [0.5, 0.1, 0.4], "target": [0, 0, 0], "vertical_fov_deg": 60, "width": 48, "height": 32, "exposure": "auto"})");
  const Finished drawn = lightwell({"render", path("o.lwc"), "--camera", path("camera.json"), "-o", path("e.png")});
  EXPECT_EQ(drawn.exit_code, 2);
  EXPECT_THAT(drawn.err, HasSubstr("--no-geometry"));
}

/// Some of its blocks hardly see the light of a lamp anywhere: they must not be made finer without bound for that.
TEST_F(CliPlanTest, PartsOfACourtyardThatLampsHardlyReachStayCheap) {
  run({"bake", LIGHTWELL_SAMPLE_SCENES "/colonnade_courtyard.glb", "--techniques", "prm", "--lightmap-size", "64", "--quality", "preview", "-o", path("o.lwc")});
  const json info = runJson({"info", path("o.lwc"), "--json"}, "info");
  EXPECT_LT(info["bytes"], 1 << 20);
}

}  // namespace
}  // namespace lightwell::test
