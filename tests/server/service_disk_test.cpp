// The disk is full: jobs wait or fail with the reason, nothing accepted is lost, and all is well once there is room again.
#include <chrono>
#include <thread>

#include "tests/server/service_fixture.h"
#include "tests/server/small_disk.h"

namespace lightwell::test {
namespace {

using nlohmann::json;

class ServiceDisk : public ServiceTest {
 protected:
  /// A daemon on a disk of 24 MB. Jobs start with `least_free` bytes of room, or more.
  bool startOnSmallDisk(uint64_t least_free, bool test_worker = false) {
    std::filesystem::create_directories(folder_ / "disk");
    disk_ = std::make_unique<SmallDisk>(folder_ / "disk", 24 << 20);
    if (!disk_->exists()) return false;
    daemon_ = std::make_unique<DaemonProcess>(folder_ / "disk" / "data",
                                              std::vector<std::string>{"--min-free-disk", std::to_string(least_free)}, test_worker,
                                              disk_->launcher());
    return true;
  }
  json jobNow(const std::string& id) const {
    const CancelFlag never;
    server::Client client(clientOptions(*daemon_), never);
    const v1::Job job = client.get(id);
    return {{"state", int(job.state())}, {"waiting_for", job.waiting_for()}};
  }
  void TearDown() override {
    ServiceTest::TearDown();
    disk_.reset();
  }
  std::unique_ptr<SmallDisk> disk_;
};

#define NEED_SMALL_DISK(...) \
  if (!startOnSmallDisk(__VA_ARGS__)) GTEST_SKIP() << "needs root or user namespaces, for a disk of its own"

TEST_F(ServiceDisk, AJobWaitsForRoomAndSaysSo) {
  NEED_SMALL_DISK(8 << 20);
  disk_->fill(4 << 20);
  const std::string room = scene("room.gltf"), job = submit(room);
  json now;
  for (int i = 0; i < 500 && (now = jobNow(job))["waiting_for"] == ""; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  EXPECT_EQ(now["state"], int(v1::JOB_STATE_QUEUED));
  EXPECT_NE(now["waiting_for"].get<std::string>().find("disk space"), std::string::npos) << now;
  disk_->makeRoom();
  EXPECT_EQ(watch(job)["state"], "succeeded");
}

TEST_F(ServiceDisk, WhatDoesNotFitIsRefusedAndTheRestIsKept) {
  NEED_SMALL_DISK(0);
  const std::string room = scene("room.gltf"), before = submit(room);
  ASSERT_EQ(watch(before)["state"], "succeeded");
  disk_->fill();
  const Finished refused = lightwell(submitArguments(scene("other.gltf", 0.25)));
  EXPECT_EQ(refused.exit_code, 5);
  EXPECT_NE(refused.err.find("full"), std::string::npos) << refused.err;
  EXPECT_EQ(client({"fetch", before, "-o", path("served.lwc")}).exit_code, 0) << "reading goes on";
  daemon_->kill();
  daemon_->start();  // on the full disk
  EXPECT_EQ(json::parse(client({"jobs", "--json"}).out)["jobs"].size(), 1u);
  disk_->makeRoom();
  const Finished accepted = lightwell(submitArguments(path("other.gltf"), {"-o", path("served.lwc")}));
  ASSERT_EQ(accepted.exit_code, 0) << accepted.err;
  EXPECT_EQ(digest(readFile(path("served.lwc"))), bake(path("other.gltf")));
}

TEST_F(ServiceDisk, ABakeThatFindsTheDiskFullFailsWithThatReason) {
  NEED_SMALL_DISK(0, true);
  const std::string slow = scene("slow.gltf"), job = submit(slow);
  while (daemon_->workers().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  disk_->fill();
  while (!daemon_->workers().empty()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_TRUE(daemon_->running()) << daemon_->log();
  disk_->makeRoom();
  const json failed = watch(job);
  EXPECT_EQ(failed["state"], "failed");
  EXPECT_EQ(failed["error"]["id"], "disk_full") << failed["error"];
  EXPECT_EQ(watch(submit(slow))["state"], "succeeded") << "the same again, with room";
}

}  // namespace
}  // namespace lightwell::test
