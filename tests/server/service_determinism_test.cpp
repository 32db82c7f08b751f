// The same scene and settings give the same bytes: for any number of threads, through the command and the service, undisturbed or killed in the middle and resumed.
#include <signal.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

struct Case {
  const char* name;
  RoomOptions room;
  std::vector<std::string> options;
};
std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class Determinism : public ServiceTest, public testing::WithParamInterface<Case> {
 protected:
  void SetUp() override { writeFile(scene_, roomGltf(GetParam().room)); }

  std::vector<std::string> words(std::vector<std::string> first, const std::vector<std::string>& more = {}) const {
    const auto& options = GetParam().options;
    first.insert(first.end(), options.begin(), options.end());
    first.insert(first.end(), more.begin(), more.end());
    return first;
  }
  std::string baked(const std::vector<std::string>& more) const {
    const Finished finished = lightwell(words({"bake", scene_, "-o", path("o.lwc")}, more));
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return digest(readFile(path("o.lwc")));
  }
  /// Returns when so many results of tasks lie in the folder, or after half a minute.
  static void waitForTasks(const std::filesystem::path& folder, size_t wanted) {
    for (int i = 0; i < 30000; ++i) {
      size_t count = 0;
      std::error_code error;
      for (std::filesystem::recursive_directory_iterator entry(folder, error), end; entry != end; entry.increment(error))
        count += entry->is_regular_file(error) && entry->path().parent_path().filename() != "tmp";
      if (count >= wanted) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  std::string bakedAfterAKill() const {
    const std::vector<std::string> cache{"--cache", path("cache"), "--threads", "2"};
    Background bake(words({"bake", scene_, "-o", path("killed.lwc")}, cache));
    waitForTasks(path("cache"), 3);
    bake.signal(SIGKILL);
    bake.wait();
    return baked({"--cache", path("cache"), "--threads", "7"});
  }
  /// By a daemon whose workers have so many threads, killed once on the way.
  std::string servedAfterAKill(const char* threads) {
    startDaemon({"--threads-per-worker", threads});
    const std::string job = submitted(words({"submit", "--server", daemon_->address(), scene_}));
    waitForTasks(daemon_->data() / "tasks", 2);
    daemon_->kill();
    daemon_->start();
    EXPECT_EQ(watch(job)["state"], "succeeded");
    EXPECT_EQ(client({"fetch", job, "-o", path("served.lwc")}).exit_code, 0);
    daemon_.reset();
    return digest(readFile(path("served.lwc")));
  }
  const std::string scene_ = path("room.gltf");
};

TEST_P(Determinism, SameBytes) {
  const std::string one = baked({"--threads", "1"});
  EXPECT_EQ(baked({"--threads", "2"}), one) << "two threads";
  EXPECT_EQ(baked({"--threads", "7"}), one) << "seven threads";
  EXPECT_EQ(bakedAfterAKill(), one) << "killed and resumed";
  EXPECT_EQ(servedAfterAKill("1"), one) << "by the service, with one thread";
  EXPECT_NE(baked({"--seed", "2"}), one) << "the comparison sees a difference";
}

const Case kCases[] = {
    {"Lamp", {.lamp_candela = 10}, {"--lightmap-size", "48", "--quality", "draft", "--techniques", "prm,lightmap,vpl"}},
    {"BoxesToUnwrap", {.emission = 1, .lamp_candela = 5, .open = true, .boxes = true, .box_emission = 3}, {"--lightmap-size", "96", "--quality", "draft", "--points", "1024"}},
    {"Portal", {.lamp_candela = 10, .shutter = true}, {"--lightmap-size", "48", "--quality", "draft", "--techniques", "radiosity,prm", "--probe-spacing", "0.5"}}};
INSTANTIATE_TEST_SUITE_P(Scenes, Determinism, testing::ValuesIn(kCases), [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace lightwell::test
