// Many clients, many small jobs: all end, nothing leaks.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

class ServiceLoad : public ServiceTest {};

/// LIGHTWELL_SERVICE_CLIENTS=64 and LIGHTWELL_SERVICE_JOBS=1000 for the long form.
TEST_F(ServiceLoad, ManyClientsSubmitAndWatch) {
  const int clients = scaled("LIGHTWELL_SERVICE_CLIENTS", 8), jobs = scaled("LIGHTWELL_SERVICE_JOBS", 24);
  startDaemon({"--workers", "2"});
  const auto files = server::filesOfScene(scene("room.gltf"));
  const CancelFlag never;
  server::Client(clientOptions(*daemon_), never).upload(files);
  const size_t descriptors_before = daemon_->openDescriptors();

  std::mutex mutex;
  std::vector<double> submit_s;
  int succeeded = 0;
  const auto begin = std::chrono::steady_clock::now();
  std::vector<std::thread> threads;
  for (int c = 0; c < clients; ++c)
    threads.emplace_back([&, c] {
      server::Client client(clientOptions(*daemon_), never);
      for (int j = c; j < jobs; j += clients) {
        const auto submitted = std::chrono::steady_clock::now();
        const auto job = client.submit(quickSpec(files, j + 1));
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - submitted).count();
        const bool done = client.watch(job.id(), {}).state() == v1::JOB_STATE_SUCCEEDED;
        std::lock_guard lock(mutex);
        submit_s.push_back(seconds);
        succeeded += done;
      }
    });
  for (auto& thread : threads) thread.join();
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  EXPECT_EQ(succeeded, jobs);
  std::sort(submit_s.begin(), submit_s.end());
  const auto percentile = [&](double p) { return 1000 * submit_s[size_t(std::min(double(submit_s.size()) - 1, std::ceil(p * double(submit_s.size())) - 1))]; };
  std::printf("%d clients, %d jobs: %.1f jobs/s; submit median %.1f ms, p99 %.1f ms; daemon %.0f MB\n", clients, jobs, jobs / seconds,
              percentile(0.5), percentile(0.99), double(daemon_->residentBytes()) / 1e6);
  EXPECT_LT(daemon_->residentBytes(), 400e6);
  // Connections of clients that are gone are closed soon.
  for (int i = 0; i < 100 && daemon_->openDescriptors() > descriptors_before + 2; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  EXPECT_LE(daemon_->openDescriptors(), descriptors_before + 2);
  EXPECT_TRUE(daemon_->workers().empty());
}

}  // namespace
}  // namespace lightwell::test
