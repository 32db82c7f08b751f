// Nothing accepted is lost, whatever is killed; what was done is not done again; the bytes are those of an undisturbed bake.
#include <signal.h>

#include <atomic>
#include <chrono>
#include <random>
#include <set>
#include <thread>

#include "server/store/sha256.h"
#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

using nlohmann::json;

class ServiceResume : public ServiceTest {
 protected:
  /// A bake of a second or two, in dozens of tasks.
  std::string submitLonger(const std::string& file) const {
    const Finished finished = client({"submit", file, "--lightmap-size", "96", "--quality", "preview", "--json"});
    EXPECT_EQ(finished.exit_code, 0) << finished.err;
    return json::parse(finished.out)["job"];
  }
  std::string bakeLonger(const std::string& file) const {
    EXPECT_EQ(lightwell({"bake", file, "-o", path("plain.lwc"), "--lightmap-size", "96", "--quality", "preview"}).exit_code, 0);
    return digest(readFile(path("plain.lwc")));
  }
  size_t finishedTasks() const {
    size_t count = 0;
    std::error_code error;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(daemon_->data() / "tasks", error))
      count += entry.is_regular_file(error) && entry.path().parent_path().filename() != "tmp";
    return count;
  }
  void waitForTasks(size_t count) const {
    for (int i = 0; i < 30000 && finishedTasks() < count; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ASSERT_GE(finishedTasks(), count);
  }
  std::string fetch(const std::string& job) const {
    EXPECT_EQ(client({"fetch", job, "-o", path("served.lwc")}).exit_code, 0);
    return digest(readFile(path("served.lwc")));
  }
};

TEST_F(ServiceResume, AfterAKillOfTheDaemon) {
  startDaemon();
  const std::string room = scene("room.gltf"), job = submitLonger(room);
  waitForTasks(3);
  const auto workers = daemon_->workers();
  daemon_->kill();
  for (const pid_t worker : workers)
    for (int i = 0; i < 1000 && isAlive(worker); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  for (const pid_t worker : workers) EXPECT_FALSE(isAlive(worker)) << "a worker outlives its daemon";
  daemon_->start();
  const json done = watch(job);
  EXPECT_EQ(done["state"], "succeeded");
  EXPECT_EQ(done["attempts"], 2);
  EXPECT_GE(done["result"]["report"]["tasks_reused"], 3);
  EXPECT_EQ(fetch(job), bakeLonger(room));
}

TEST_F(ServiceResume, AfterAKillOfTheWorker) {
  startDaemon();
  const std::string room = scene("room.gltf"), job = submitLonger(room);
  waitForTasks(3);
  for (const pid_t worker : daemon_->workers()) ::kill(worker, SIGKILL);
  const json done = watch(job);
  EXPECT_EQ(done["state"], "succeeded");
  EXPECT_EQ(done["attempts"], 2);
  EXPECT_GE(done["result"]["report"]["tasks_reused"], 3);
  EXPECT_EQ(fetch(job), bakeLonger(room));
}

TEST_F(ServiceResume, SigtermEndsWithin5SecondsAndTheJobGoesOnLater) {
  startDaemon();
  const std::string room = scene("room.gltf"), job = submitLonger(room);
  waitForTasks(2);
  Background watcher({"watch", "--server", daemon_->address(), job});
  double seconds = 0;
  EXPECT_EQ(daemon_->terminate(&seconds), 0);
  EXPECT_LT(seconds, 5);
  daemon_->start();
  EXPECT_EQ(watcher.wait().exit_code, 0) << "a watch outlives a restart";
  EXPECT_EQ(fetch(job), bakeLonger(room));
}

TEST_F(ServiceResume, AWorkerThatIsKilledAgainAndAgainIsGivenUp) {
  startDaemon({}, true);
  const std::string job = submit(scene("hang.gltf"));
  std::atomic<bool> done{false};
  std::thread killer([&] {
    while (!done) {
      for (const pid_t worker : daemon_->workers()) ::kill(worker, SIGKILL);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  });
  const json failed = watch(job);
  done = true;
  killer.join();
  EXPECT_EQ(failed["state"], "failed");
  EXPECT_EQ(failed["error"]["id"], "worker_killed");
}

/// Clients submit without a pause while the daemon is killed at random moments. LIGHTWELL_SERVICE_KILLS=100 for the long form.
TEST_F(ServiceResume, KillsUnderLoad) {
  const int kills = scaled("LIGHTWELL_SERVICE_KILLS", 4);
  startDaemon({"--workers", "2"});
  constexpr int kClients = 3;
  std::vector<std::vector<server::LocalFile>> scenes;
  for (int i = 0; i < kClients; ++i) scenes.push_back(server::filesOfScene(scene("room" + std::to_string(i) + ".gltf", 0.3 + 0.2 * i)));
  struct Accepted {
    std::string id;
    int scene, seed;
  };
  std::mutex mutex;
  std::vector<Accepted> accepted;
  std::atomic<bool> stop{false};
  std::vector<std::thread> clients;
  for (int c = 0; c < kClients; ++c)
    clients.emplace_back([&, c] {
      const CancelFlag never;
      server::Client client(clientOptions(*daemon_), never);
      for (int seed = 1; !stop && seed < 100000; ++seed) {
        client.upload(scenes[size_t(c)]);
        const auto job = client.submit(quickSpec(scenes[size_t(c)], seed));
        {
          std::lock_guard lock(mutex);
          accepted.push_back({job.id(), c, seed});
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(300));
      }
    });
  std::mt19937 random(7);
  for (int i = 0; i < kills; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(std::uniform_int_distribution<int>(50, 1200)(random)));
    daemon_->kill();
    daemon_->start();
  }
  stop = true;
  for (auto& client : clients) client.join();

  const CancelFlag never;
  server::Client client(clientOptions(*daemon_), never);
  std::set<std::string> ids;
  for (const auto& job : accepted) {
    EXPECT_TRUE(ids.insert(job.id).second) << "two submits, one job";
    const auto done = client.watch(job.id, {});
    ASSERT_EQ(done.state(), v1::JOB_STATE_SUCCEEDED) << done.error().message();
  }
  // Neither lost nor doubled: what the server lists is what was accepted.
  std::set<std::string> listed;
  v1::ListJobsRequest request;
  do {
    const auto page = client.list(request);
    for (const auto& job : page.jobs()) listed.insert(job.id());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  EXPECT_EQ(listed, ids);
  EXPECT_GE(accepted.size(), size_t(kClients));
  // Every result is that of an undisturbed bake; the short form compares a sample.
  const size_t step = kills >= 50 ? 1 : std::max<size_t>(1, accepted.size() / 6);
  for (size_t i = 0; i < accepted.size(); i += step) {
    const auto& job = accepted[i];
    const std::string plain = bake(path("room" + std::to_string(job.scene) + ".gltf"), {"--seed", std::to_string(job.seed)});
    const auto served = client.download(job.id);
    EXPECT_EQ(digest(std::string(served.begin(), served.end())), plain) << job.id;
  }
  std::printf("%d kills, %zu jobs accepted, none lost, none doubled\n", kills, accepted.size());
}

}  // namespace
}  // namespace lightwell::test
