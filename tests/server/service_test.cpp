// The service as its users see it: submit, watch, fetch, cancel, from the command.
#include <chrono>
#include <thread>

#include "tests/cli/schema.h"
#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

using nlohmann::json;

class Service : public ServiceTest {};

TEST_F(Service, OneLineGivesTheBytesOfABake) {
  startDaemon();
  const std::string room = scene("room.gltf");
  const Finished finished = lightwell(submitArguments(room, {"--watch", "-o", path("served.lwc"), "--json"}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err << daemon_->log();
  EXPECT_EQ(digest(readFile(path("served.lwc"))), bake(room));
  const json document = json::parse(finished.out);
  EXPECT_EQ(schemaViolation(readSchema("job"), document), "");
  EXPECT_EQ(document["state"], "succeeded");
  EXPECT_EQ(document["result"]["from_cache"], false);
  EXPECT_GT(document["result"]["report"]["tasks_run"], 0);
}

TEST_F(Service, ASceneOfSeveralFilesInFolders) {
  startDaemon();
  std::filesystem::create_directories(folder_ / "level" / "mesh data");
  json gltf = json::parse(roomGltf({.lamp_candela = 10}));
  // The buffer moves to a file of its own, whose name needs encoding.
  const std::string uri = gltf["buffers"][0]["uri"];
  json moved{{"asset", {{"version", "2.0"}}}};
  gltf["buffers"][0]["uri"] = "mesh%20data/room.bin";
  std::string bytes;
  {  // decode the base64 payload by hand: a test must not trust what it tests
    const std::string payload = uri.substr(uri.find(',') + 1);
    static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    uint32_t bits = 0, count = 0;
    for (const char c : payload) {
      if (c == '=') break;
      bits = bits << 6 | uint32_t(kDigits.find(c));
      if ((count += 6) >= 8) bytes += char(bits >> (count -= 8) & 0xff);
    }
  }
  writeFile(folder_ / "level" / "mesh data" / "room.bin", bytes);
  writeFile(folder_ / "level" / "room.gltf", gltf.dump());
  writeFile(path("lamps.json"), R"({"lights": [{"type": "point", "position": [0, 0.5, 0], "intensity": 5}]})");
  const std::string level = path("level/room.gltf");
  const Finished finished = lightwell(submitArguments(level, {"--lights", path("lamps.json"), "-o", path("served.lwc")}));
  ASSERT_EQ(finished.exit_code, 0) << finished.err;
  EXPECT_EQ(digest(readFile(path("served.lwc"))), bake(level, {"--lights", path("lamps.json")}));
}

TEST_F(Service, TheSameRequestIsAnsweredFromTheCache) {
  startDaemon();
  const std::string room = scene("room.gltf");
  ASSERT_EQ(watch(submit(room))["state"], "succeeded");
  const json again = watch(submit(room, {"--priority", "3", "--label", "again"}));
  EXPECT_EQ(again["result"]["from_cache"], true);
  EXPECT_EQ(again["attempts"], 0);
  const json other = watch(submit(room, {"--seed", "2"}));
  EXPECT_EQ(other["result"]["from_cache"], false);
}

TEST_F(Service, OnlyWhatChangedIsBakedAgain) {
  startDaemon();
  const std::string room = scene("room.gltf");
  const json first = watch(submit(room));
  // Another lamp: no transport changes.
  writeFile(room, roomGltf({.lamp_candela = 20}));
  const json second = watch(submit(room));
  EXPECT_GT(second["result"]["report"]["tasks_reused"], 0);
  EXPECT_EQ(second["result"]["report"]["tasks_run"], 1);
  EXPECT_GT(first["result"]["report"]["tasks_run"], 5);
  ASSERT_EQ(client({"fetch", second["job"], "-o", path("served.lwc")}).exit_code, 0);
  EXPECT_EQ(digest(readFile(path("served.lwc"))), bake(room));
}

TEST_F(Service, WatchShowsWhatWasReused) {
  startDaemon();
  RoomOptions room{.lamp_candela = 10, .boxes = true};
  const auto change = [&](const char* what, const std::string& clusters = "256") {
    writeFile(path("boxes.gltf"), roomGltf(room));
    const std::vector<std::string> options{"--lightmap-size", "48", "--quality", "draft", "--prm-clusters", clusters};
    const std::string job = submitAs(path("boxes.gltf"), options);
    const Finished watched = client({"watch", job, "--json"});
    const json done = json::parse(watched.out);
    EXPECT_EQ(done["progress"]["tasks_reused"], done["result"]["report"]["tasks_reused"]) << what;
    EXPECT_EQ(done["progress"]["tasks_done"], done["progress"]["tasks_total"]) << what;
    EXPECT_EQ(client({"fetch", job, "-o", path("served.lwc")}).exit_code, 0);
    EXPECT_EQ(digest(readFile(path("served.lwc"))), bakeAs(path("boxes.gltf"), options)) << what;
    const int reused = done["progress"]["tasks_reused"];
    EXPECT_EQ(watched.err.find("tasks reused") != std::string::npos, reused > 0) << watched.err;
    return reused;
  };
  EXPECT_EQ(change("from nothing"), 0);
  room.box_albedo = 0.25;
  EXPECT_GT(change("one material's colour"), 0);
  room.box_x = -0.4;
  EXPECT_GT(change("one object moved"), 0);
  EXPECT_GT(change("only settings of the radiance maps", "200"), 0);
}

TEST_F(Service, AMeasuredErrorIsPartOfTheProgress) {
  startDaemon();
  const json done = watch(submitAs(scene("room.gltf"), {"--lightmap-size", "24", "--quality", "preview"}));
  ASSERT_TRUE(done["progress"]["relrmse"].is_number()) << done["progress"];
  EXPECT_EQ(done["progress"]["relrmse"], done["result"]["report"]["error"][0]["relrmse"]);
}

TEST_F(Service, AFailedJobSaysWhyAndExitsWith5) {
  startDaemon();
  writeFile(path("broken.gltf"), R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [7]}]})");
  const Finished finished = lightwell(submitArguments(path("broken.gltf"), {"--watch"}));
  EXPECT_EQ(finished.exit_code, 5);
  EXPECT_NE(finished.err.find("broken.gltf: scenes[0].nodes[0]"), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find(folder_.string()), std::string::npos) << "no place of the server's disk is told: " << finished.err;
}

TEST_F(Service, ASceneCannotReachOutsideItsUpload) {
  startDaemon();
  writeFile(path("secret.bin"), std::string(1000, 's'));
  std::filesystem::create_directory(folder_ / "level");
  for (const auto& uri : std::vector<std::string>{"../secret.bin", path("secret.bin"), "jobs.sqlite", "../../jobs.sqlite", "%2e%2e/secret.bin"}) {
    json gltf = json::parse(roomGltf({}));
    gltf["buffers"][0]["uri"] = uri;
    writeFile(folder_ / "level" / "room.gltf", gltf.dump());
    const json job = watch(submit(path("level/room.gltf")));
    EXPECT_EQ(job["state"], "failed") << uri;
    EXPECT_EQ(job["error"]["id"], "input_rejected") << uri;
  }
}

TEST_F(Service, AQueuedAndARunningJobAreCancelledWithinASecond) {
  startDaemon({"--workers", "1"}, true);
  const std::string running = submit(scene("hang.gltf")), queued = submit(scene("room.gltf"));
  while (daemon_->workers().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  for (const std::string& job : {queued, running}) {
    const auto begin = std::chrono::steady_clock::now();
    const Finished finished = client({"cancel", job, "--json"});
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    EXPECT_EQ(json::parse(finished.out)["state"], "cancelled");
    EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::milliseconds(1500)) << "a second, and the command's start";
  }
  EXPECT_TRUE(daemon_->workers().empty());
  EXPECT_EQ(client({"watch", running}).exit_code, 5);
  size_t temporaries = 0;
  std::error_code absent;
  for (const char* folder : {"tasks/tmp", "uploads"})
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(daemon_->data() / folder, absent)) ++temporaries;
  EXPECT_EQ(temporaries, 0u);
}

TEST_F(Service, CtrlCDetachesAndSaysHowToComeBack) {
  startDaemon({}, true);
  Background command(submitArguments(scene("hang.gltf"), {"--watch"}));
  ASSERT_TRUE(command.waitFor([&] { return command.errors().find("starting") != std::string::npos; })) << command.errors();
  command.signal(SIGINT);
  const Finished finished = command.wait();
  EXPECT_EQ(finished.exit_code, 130);
  EXPECT_NE(finished.err.find("lightwell watch --server " + daemon_->address()), std::string::npos) << finished.err;
  EXPECT_EQ(finished.err.find("waiting for a server"), std::string::npos) << "it answers:\n" << finished.err;
  EXPECT_EQ(daemon_->workers().size(), 1u) << "the job goes on";
}

TEST_F(Service, JobsAreListedNewestFirstAndFiltered) {
  startDaemon();
  const std::string room = scene("room.gltf");
  const std::string a = submit(room, {"--label", "first"}), b = submit(room, {"--label", "second"});
  watch(a), watch(b);
  const json all = json::parse(client({"jobs", "--json"}).out);
  ASSERT_EQ(all["jobs"].size(), 2u);
  EXPECT_EQ(all["jobs"][0]["job"], b);
  const json labelled = json::parse(client({"jobs", "--json", "--label", "first"}).out);
  ASSERT_EQ(labelled["jobs"].size(), 1u);
  EXPECT_EQ(labelled["jobs"][0]["job"], a);
  EXPECT_EQ(json::parse(client({"jobs", "--json", "--state", "failed"}).out)["jobs"].size(), 0u);
  EXPECT_EQ(client({"cancel", a, "--delete"}).exit_code, 0);
  EXPECT_EQ(json::parse(client({"jobs", "--json"}).out)["jobs"].size(), 1u);
  EXPECT_EQ(client({"watch", a}).exit_code, 5);
}

TEST_F(Service, ASubmitThatIsRepeatedMakesOneJob) {
  startDaemon();
  const auto files = server::filesOfScene(scene("room.gltf"));
  const CancelFlag never;
  server::Client client(clientOptions(*daemon_), never);
  client.upload(files);
  const std::string first = client.submit(quickSpec(files)).id();
  EXPECT_NE(client.submit(quickSpec(files)).id(), first) << "two calls, two keys";
  EXPECT_EQ(client.list({}).jobs_size(), 2);
}

TEST(ServiceAbsent, AnUnreachableServerIsExit5) {
  const Finished finished = lightwell({"jobs", "--server", "127.0.0.1:" + std::to_string(freePort())});
  EXPECT_EQ(finished.exit_code, 5);
  EXPECT_NE(finished.err.find("cannot be reached"), std::string::npos);
}

TEST_F(Service, ACommandWaitsForADaemonThatIsStarting) {
  startDaemon();
  const std::string room = scene("room.gltf");
  daemon_->kill();
  Background command(submitArguments(room, {"--watch"}));
  ASSERT_TRUE(command.waitFor([&] { return command.errors().find("waiting for a server at " + daemon_->address()) != std::string::npos; }))
      << command.errors();
  daemon_->start();
  EXPECT_EQ(command.wait().exit_code, 0);
}

}  // namespace
}  // namespace lightwell::test
