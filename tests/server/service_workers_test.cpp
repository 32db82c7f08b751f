// Jobs that crash, exhaust, hang or lie: they fail with their reason, others go on, the daemon stays.
#include <chrono>
#include <fstream>
#include <random>
#include <thread>

#include "precompute/core/sanitizer.h"
#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

using nlohmann::json;

class ServiceWorkers : public ServiceTest {};

TEST_F(ServiceWorkers, ACrashEndsItsJobAlone) {
  startDaemon({}, true);
  const std::string crash = submit(scene("crash.gltf")), sound = submit(scene("room.gltf"));
  const json failed = watch(crash);
  EXPECT_EQ(failed["state"], "failed");
  EXPECT_EQ(failed["error"]["id"], "worker_crashed");
  EXPECT_NE(failed["error"]["message"].get<std::string>().find("Segmentation fault"), std::string::npos);
  EXPECT_EQ(failed["error"]["stderr_tail"], "about to crash on purpose\n");
  EXPECT_EQ(watch(sound)["state"], "succeeded");
}

TEST_F(ServiceWorkers, AWorkerWithoutAWordIsACrash) {
  startDaemon({}, true);
  EXPECT_EQ(watch(submit(scene("exit.gltf")))["error"]["id"], "worker_crashed");
}

TEST_F(ServiceWorkers, MemoryIsLimited) {
  if (kSanitized) GTEST_SKIP() << "workers with a sanitizer have no hard limit: its shadow memory is beyond any";
  startDaemon({"--max-job-memory", "512MiB"}, true);
  const json failed = watch(submit(scene("exhaust.gltf")));
  EXPECT_EQ(failed["state"], "failed");
  EXPECT_NE(failed["error"]["stderr_tail"].get<std::string>().find("no memory left"), std::string::npos) << failed.dump();
  EXPECT_EQ(watch(submit(scene("room.gltf")))["state"], "succeeded");
}

TEST_F(ServiceWorkers, EstimatedMemoryIsCheckedBeforeTheStart) {
  startDaemon();
  const json failed = watch(submit(scene("room.gltf"), {"--memory-limit", "1MB"}));
  EXPECT_EQ(failed["error"]["id"], "memory_limit");
  EXPECT_EQ(failed["attempts"], 0);
}

TEST_F(ServiceWorkers, ARealFileThatWantsMoreMemoryThanAllowed) {
  startDaemon({"--max-job-memory", "300MiB"});
  // An accessor without data of its own may claim millions of vertices: small file, large scene.
  json gltf{{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}, {"nodes", {{{"mesh", 0}}}}};
  gltf["accessors"] = {{{"componentType", 5126}, {"count", 4000000}, {"type", "VEC3"}, {"min", {0, 0, 0}}, {"max", {0, 0, 0}}}};
  gltf["meshes"] = {{{"primitives", json::array()}}};
  for (int i = 0; i < 12; ++i) gltf["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}, {"NORMAL", 0}, {"TANGENT", 0}}}});
  writeFile(path("bomb.gltf"), gltf.dump());
  const json ended = watch(submit(path("bomb.gltf")));
  EXPECT_EQ(ended["error"]["id"], "memory_limit") << ended.dump();
  EXPECT_EQ(watch(submit(scene("room.gltf")))["state"], "succeeded") << "others go on";
}

TEST_F(ServiceWorkers, ARealFileThatWantsMoreTimeThanAllowed) {
  startDaemon({"--workers", "2", "--max-job-seconds", "4"});
  // Long thin triangles through one point, in all directions: no hierarchy of boxes parts them, and every ray meets many.
  constexpr uint32_t kTriangles = 30000;
  std::string positions;
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  for (uint32_t i = 0; i < 3 * kTriangles; ++i)
    for (int c = 0; c < 3; ++c) {
      const float value = (i % 3 == 2 ? 0.01f : 1.0f) * normal(random);
      positions.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
  writeFile(path("needles.bin"), positions);
  json gltf{{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}, {"nodes", {{{"mesh", 0}}}}};
  gltf["buffers"] = {{{"uri", "needles.bin"}, {"byteLength", positions.size()}}};
  gltf["bufferViews"] = {{{"buffer", 0}, {"byteLength", positions.size()}}};
  gltf["accessors"] = {{{"bufferView", 0}, {"componentType", 5126}, {"count", 3 * kTriangles}, {"type", "VEC3"},
                        {"min", {-9, -9, -9}}, {"max", {9, 9, 9}}}};
  gltf["meshes"] = {{{"primitives", {{{"attributes", {{"POSITION", 0}}}}}}}};
  writeFile(path("needles.gltf"), gltf.dump());
  const std::string needles = submitAs(path("needles.gltf"), {"--lightmap-size", "1024"});
  EXPECT_EQ(watch(submit(scene("room.gltf")))["state"], "succeeded") << "others go on beside it";
  const json ended = watch(needles);
  EXPECT_EQ(ended["error"]["id"], "time_limit") << ended.dump();
  EXPECT_TRUE(daemon_->workers().empty());
}

TEST_F(ServiceWorkers, TimeIsLimited) {
  startDaemon({"--workers", "1"}, true);
  const auto begin = std::chrono::steady_clock::now();
  const json failed = watch(submit(scene("hang.gltf"), {"--wall-limit", "1"}));
  EXPECT_EQ(failed["error"]["id"], "time_limit");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
  EXPECT_TRUE(daemon_->workers().empty());
}

TEST_F(ServiceWorkers, WorkersAreLowInPriorityAndHoldNothingOfTheDaemon) {
  startDaemon({}, true);
  submit(scene("hang.gltf"));
  while (daemon_->workers().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const std::string proc = "/proc/" + std::to_string(daemon_->workers().at(0));
  std::ifstream stat(proc + "/stat");
  std::string word;
  for (int i = 0; i < 19; ++i) stat >> word;
  EXPECT_GE(std::stoi(word), 10) << "nice";
  EXPECT_GE(std::stoi(readFile(proc + "/oom_score_adj")), 900);
}

TEST_F(ServiceWorkers, ClientsTakeTurns) {
  writeFile(path("tokens"), "anna " + std::string(20, 'a') + "\nbert " + std::string(20, 'b') + "\n");
  std::filesystem::permissions(path("tokens"), std::filesystem::perms::owner_read);
  startDaemon({"--workers", "1", "--token-file", path("tokens")}, true);
  const auto files = server::filesOfScene(scene("slow.gltf"));
  const auto clientOf = [&](const char* name) {
    writeFile(path(name), std::string(20, name[0]));
    auto options = clientOptions(*daemon_);
    options.token_file = path(name);
    return options;
  };
  const CancelFlag never;
  server::Client anna(clientOf("a"), never), bert(clientOf("b"), never);
  anna.upload(files), bert.upload(files);
  std::vector<std::string> of_anna, of_bert;
  for (int seed = 1; seed <= 3; ++seed) of_anna.push_back(anna.submit(quickSpec(files, seed)).id());
  of_bert.push_back(bert.submit(quickSpec(files, 9)).id());
  auto urgent = quickSpec(files, 10);
  urgent.set_priority(5);
  const std::string first = anna.submit(urgent).id();
  for (const auto& id : of_anna) anna.watch(id, {});
  anna.watch(first, {}), bert.watch(of_bert[0], {});
  EXPECT_LT(anna.get(first).started_ms(), bert.get(of_bert[0]).started_ms()) << "priority first";
  EXPECT_LT(bert.get(of_bert[0]).started_ms(), anna.get(of_anna[1]).started_ms()) << "then in turns";
  EXPECT_THROW(bert.get(first), server::ServiceError) << "others' jobs are not there";
}

}  // namespace
}  // namespace lightwell::test
