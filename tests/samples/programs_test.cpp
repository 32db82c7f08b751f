// The game and the relighting, run as people run them, without a window.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "render/camera_json.h"
#include "render/lights_json.h"
#include "tests/render/stage.h"

namespace lightwell {
namespace {

namespace fs = std::filesystem;

class Programs : public testing::Test {
 protected:
  Programs() {
    std::string name = (fs::temp_directory_path() / "lightwell-programs-XXXXXX").string();
    folder = mkdtemp(name.data());
    const auto bytes = test::makeStage(true);
    std::ofstream(folder / "stage.lwc", std::ios::binary).write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    write("camera.json", R"({"eye": [0, 3, 6], "target": [0, 0, 0], "exposure": 0})");
    write("left.json", R"({"lights": [{"type": "point", "position": [-2, 2, 0], "intensity": 50}]})");
    write("right.json", R"({"lights": [{"type": "point", "position": [2, 2, 0], "intensity": 50}]})");
  }
  ~Programs() override { fs::remove_all(folder); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder / name) << text; }
  /// Runs in the folder and returns the exit code; `said` receives stdout and stderr.
  int run(const std::string& command) {
    const int status = std::system(("cd '" + folder.string() + "' && " + command + " > said.txt 2>&1").c_str());
    said = read("said.txt");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string read(const std::string& name) {
    std::ifstream in(folder / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// Width and height of a PNG, from its header; 0 × 0 when it is none.
  std::pair<int, int> pngSize(const std::string& name) {
    const std::string bytes = read(name);
    if (bytes.size() < 24 || bytes.compare(1, 3, "PNG") != 0) return {0, 0};
    const auto big = [&](size_t at) {
      int value = 0;
      for (size_t i = 0; i < 4; ++i) value = value << 8 | uint8_t(bytes[at + i]);
      return value;
    };
    return {big(16), big(20)};
  }

  fs::path folder;
  std::string said;
};

TEST_F(Programs, GameDrawsItsScriptedPath) {
  ASSERT_EQ(run(LIGHTWELL_GAME " stage.lwc --headless --frames 3 --size 96x64 --lights left.json -o walk"), 0) << said;
  EXPECT_THAT(said, testing::HasSubstr("3 frames of 96 x 64, full light"));
  for (const char* name : {"walk_000.png", "walk_001.png", "walk_002.png"}) EXPECT_EQ(pngSize(name), std::pair(96, 64)) << name;
  EXPECT_FALSE(fs::exists(folder / "walk_003.png"));
  EXPECT_NE(read("walk_000.png"), read("walk_001.png")) << "the lamp moves";
}

TEST_F(Programs, GamePicturesAreTheSameOnEsAndEachTime) {
  ASSERT_EQ(run(LIGHTWELL_GAME " stage.lwc --headless --camera camera.json --size 64x64 -o a"), 0) << said;
  ASSERT_EQ(run(LIGHTWELL_GAME " stage.lwc --headless --camera camera.json --size 64x64 -o b"), 0) << said;
  EXPECT_EQ(read("a_000.png"), read("b_000.png"));
  EXPECT_EQ(run(LIGHTWELL_GAME " stage.lwc --headless --es --camera camera.json --size 64x64 -o c"), 0) << said;
  EXPECT_THAT(said, testing::HasSubstr("OpenGL ES"));
}

TEST_F(Programs, GameShowsTheParts) {
  const std::string command = LIGHTWELL_GAME " stage.lwc --headless --camera camera.json --lights right.json --size 64x64";
  for (const std::string mode : {"direct", "indirect", "full"}) ASSERT_EQ(run(command + " --mode " + mode + " -o " + mode), 0) << said;
  EXPECT_NE(read("direct_000.png"), read("full_000.png"));
  EXPECT_NE(read("indirect_000.png"), read("full_000.png"));
}

TEST_F(Programs, GameRefusesWhatCannotBe) {
  EXPECT_EQ(run(LIGHTWELL_GAME " stage.lwc --headless --size 0x10"), 2) << said;
  EXPECT_EQ(run(LIGHTWELL_GAME " nowhere.lwc --headless"), 4) << said;
  EXPECT_EQ(run(LIGHTWELL_GAME " camera.json --headless"), 4) << said;
  EXPECT_THAT(said, testing::HasSubstr("LW_BAD_MAGIC"));
  EXPECT_EQ(run(LIGHTWELL_GAME " stage.lwc --headless --camera left.json"), 3) << said;
  EXPECT_THAT(said, testing::HasSubstr("left.json: lights: is not a known key"));
}

TEST_F(Programs, RelightingDrawsDirectBesideFull) {
  ASSERT_EQ(run(LIGHTWELL_RELIGHT " stage.lwc --camera camera.json --lights left.json right.json -o out --reduction 4"), 0) << said;
  for (const char* name : {"out/left_direct.png", "out/left_full.png", "out/right_direct.png", "out/right_full.png"})
    EXPECT_EQ(pngSize(name), std::pair(1280, 720)) << name;
  EXPECT_EQ(pngSize("out/contact_sheet.png"), std::pair(2 * 320 + 4, 2 * 180 + 4));
}

TEST(SampleFiles, CamerasAndLightsAreAccepted) {
  const double origin[3] = {0, 0, 0};
  for (const char* name : {"colonnade_courtyard", "cornell_box", "corridor_door", "marble_chamber"})
    EXPECT_NO_THROW(render::readCamera(fs::path(LIGHTWELL_SAMPLES) / "cameras" / (std::string(name) + ".json"))) << name;
  for (const char* name : {"aisle", "nave", "stair"})
    EXPECT_EQ(render::readLights(fs::path(LIGHTWELL_SAMPLES) / "lights" / (std::string(name) + ".json"), origin).size(), 1u) << name;
}

}  // namespace
}  // namespace lightwell
