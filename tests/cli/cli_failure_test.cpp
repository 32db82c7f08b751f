// What the command does when something is wrong: the exit code tells whose fault it is, the message says where, nothing is left behind.
#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>

#include "tests/cli/process.h"
#include "tests/cli/scenes.h"

namespace lightwell::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// Results of tasks in a cache folder; unfinished files in its folder "tmp" do not count.
size_t resultsIn(const std::filesystem::path& cache) {
  size_t count = 0;
  std::error_code ignored;
  for (const auto& folder : std::filesystem::directory_iterator(cache, ignored))
    if (folder.path().filename() != "tmp") ++count;
  return count;
}

class CliFailureTest : public FolderTest {
 protected:
  void SetUp() override {
    writeFile(path("room.gltf"), roomGltf({.lamp_candela = 1}));
  }
  void expectFailure(const std::vector<std::string>& arguments, int exit_code, const std::string& message) {
    const Finished finished = lightwell(arguments);
    std::string line;
    for (const auto& argument : arguments) line += argument + " ";
    EXPECT_EQ(finished.exit_code, exit_code) << line << finished.err;
    EXPECT_THAT(finished.err, HasSubstr(message)) << line;
    EXPECT_EQ(finished.out, "") << line;
  }
  void bakeDraft(const std::string& output) {
    const Finished finished = lightwell({"bake", path("room.gltf"), "-o", path(output), "--lightmap-size", "16", "--quality", "draft"});
    ASSERT_EQ(finished.exit_code, 0) << finished.err;
  }
};

TEST_F(CliFailureTest, WrongUsageIs2) {
  const std::string scene = path("room.gltf"), out = path("o.lwc");
  expectFailure({}, 2, "subcommand");
  expectFailure({"bake"}, 2, "required");
  expectFailure({"bake", scene, "-o", out, "--no-such-option"}, 2, "--no-such-option");
  expectFailure({"bake", scene, "-o", out, "--lightmap-size", "0"}, 2, "--lightmap-size");
  expectFailure({"bake", scene, "-o", out, "--lightmap-size", "8193"}, 2, "--lightmap-size");
  expectFailure({"bake", scene, "-o", out, "--lightmap-size", "many"}, 2, "--lightmap-size");
  expectFailure({"bake", scene, "-o", out, "--seed", "-1"}, 2, "--seed");
  expectFailure({"bake", scene, "-o", out, "--threads", "-1"}, 2, "--threads");
  expectFailure({"bake", scene, "-o", out, "--quality", "best"}, 2, "--quality");
  expectFailure({"bake", scene, "-o", out, "--techniques", "prm,magic"}, 2, "magic");
  expectFailure({"bake", scene, "-o", out, "--virtual-lights", "10"}, 2, "--techniques vpl");
  expectFailure({"reference", scene, "-o", path("o.exr"), "--component", "all"}, 2, "--component");
  expectFailure({"reference", scene, "-o", path("o.exr"), "--samples", "0"}, 2, "--samples");
  EXPECT_THAT(listing(), ElementsAre("room.gltf"));
}

TEST_F(CliFailureTest, PlaceThatCannotBeWrittenIs2BeforeAnyWork) {
  const std::string scene = path("room.gltf");
  expectFailure({"bake", scene, "-o", path("missing/o.lwc")}, 2, "missing");
  expectFailure({"bake", scene, "-o", path("")}, 2, "folder");
  expectFailure({"bake", scene, "-o", folder_.string()}, 2, "not a regular file");
  expectFailure({"bake", scene, "-o", path("room.gltf/o.lwc")}, 2, "no folder");
  expectFailure({"bake", scene, "-o", path("o.lwc"), "--cache", path("room.gltf/cache")}, 2, "cache");
  expectFailure({"reference", scene, "-o", path("missing/o.exr")}, 2, "missing");
}

TEST_F(CliFailureTest, RejectedInputIs3AndIsNamed) {
  const std::string out = path("o.lwc");
  expectFailure({"bake", path("none.glb"), "-o", out}, 3, "none.glb: no such file");
  writeFile(path("bad.glb"), "glTF but not really");
  expectFailure({"bake", path("bad.glb"), "-o", out}, 3, "bad.glb");
  std::string escaping = roomGltf({});
  const size_t uri = escaping.find("data:application");
  escaping.replace(uri, escaping.find('"', uri) - uri, "../secret.bin");
  writeFile(path("escaping.gltf"), escaping);
  expectFailure({"bake", path("escaping.gltf"), "-o", out}, 3, "buffers[0]");
  writeFile(path("bad.json"), R"({"lights":[{"type":"point","position":[0,0],"intensity":1}]})");
  expectFailure({"bake", path("room.gltf"), "-o", out, "--lights", path("bad.json")}, 3, "lights[0].position");
  expectFailure({"compare", path("none.exr"), path("none.exr")}, 3, "none.exr");
  EXPECT_FALSE(std::filesystem::exists(out));
}

TEST_F(CliFailureTest, DamagedContainerIs4) {
  bakeDraft("o.lwc");
  const std::string whole = readFile(path("o.lwc"));
  writeFile(path("cam.json"), R"({"eye":[0,0,0.9],"target":[0,0,-1],"width":16,"height":16})");
  for (const size_t byte : {size_t(3), size_t(20), size_t(70), whole.size() / 2, whole.size() - 1}) {
    std::string damaged = whole;
    damaged[byte] ^= 0x20;
    writeFile(path("x.lwc"), damaged);
    expectFailure({"verify", path("x.lwc")}, 4, "x.lwc");
    writeFile(path("x.lwc"), whole.substr(0, byte));
    expectFailure({"verify", path("x.lwc")}, 4, "x.lwc");
    expectFailure({"info", path("x.lwc")}, 4, "x.lwc");
    expectFailure({"evaluate", path("x.lwc"), "--technique", "prm", "-o", path("e.exr")}, 4, "x.lwc");
    expectFailure({"render", path("x.lwc"), "--camera", path("cam.json"), "-o", path("e.png")}, 4, "x.lwc");
  }
  EXPECT_FALSE(std::filesystem::exists(path("e.exr")));
}

TEST_F(CliFailureTest, EvaluatingWhatIsNotThereIs2) {
  writeFile(path("empty.gltf"), roomGltf({.surfaces = false}));
  ASSERT_EQ(lightwell({"bake", path("empty.gltf"), "-o", path("o.lwc")}).exit_code, 0);
  expectFailure({"evaluate", path("o.lwc"), "--technique", "prm", "-o", path("e.exr")}, 2, "no surfaces");
  expectFailure({"evaluate", path("o.lwc"), "--technique", "vpl", "-o", path("e.exr")}, 2, "vpl");
}

TEST_F(CliFailureTest, SizeLimitThatNothingMeetsIs2) {
  expectFailure({"bake", path("room.gltf"), "-o", path("o.lwc"), "--lightmap-size", "12", "--quality", "draft", "--size-limit", "100"}, 2,
                "smallest container");
  EXPECT_FALSE(std::filesystem::exists(path("o.lwc")));
}

TEST_F(CliFailureTest, FailedBakeKeepsTheOldContainer) {
  writeFile(path("o.lwc"), "old");
  writeFile(path("bad.glb"), "nonsense");
  expectFailure({"bake", path("bad.glb"), "-o", path("o.lwc")}, 3, "bad.glb");
  EXPECT_EQ(readFile(path("o.lwc")), "old");
}

TEST_F(CliFailureTest, InterruptEndsWithinASecondAndLeavesNothing) {
  // The stages at which the signal comes: while tasks run, and while nothing polls yet.
  for (const char* stage : {"tasks", "import"}) {
    for (const int number : {SIGINT, SIGTERM}) {
      Background bake({"bake", path("room.gltf"), "-o", path("o.lwc"), "--lightmap-size", "256", "--quality", "production"});
      ASSERT_TRUE(bake.waitFor([&] { return bake.errors().find(stage) != std::string::npos; })) << bake.wait().err;
      const auto begin = std::chrono::steady_clock::now();
      bake.signal(number);
      const Finished finished = bake.wait();
      EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1500)) << stage;
      EXPECT_EQ(finished.exit_code, 130) << stage << finished.err;
      EXPECT_THAT(finished.err, HasSubstr("interrupted"));
      EXPECT_THAT(listing(), ElementsAre("room.gltf"));
    }
  }
}

TEST_F(CliFailureTest, InterruptedBakeGoesOnFromItsCache) {
  const std::vector<std::string> arguments{"bake", path("room.gltf"), "-o",    path("o.lwc"), "--lightmap-size",
                                           "64",   "--quality",       "draft", "--threads",   "1"};
  ASSERT_EQ(lightwell(arguments).exit_code, 0);
  const std::string whole = readFile(path("o.lwc"));
  std::filesystem::remove(path("o.lwc"));
  std::vector<std::string> cached = arguments;
  cached.insert(cached.end(), {"--cache", path("cache")});
  Background bake(cached);
  ASSERT_TRUE(bake.waitFor([&] { return resultsIn(path("cache")) >= 3; }));
  bake.signal(SIGKILL);  // if it was faster than that: all the better reused
  bake.wait();
  const Finished resumed = lightwell(cached);
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_THAT(resumed.err, HasSubstr("reused"));
  EXPECT_TRUE(readFile(path("o.lwc")) == whole);
}

}  // namespace
}  // namespace lightwell::test
