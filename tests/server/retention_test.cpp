// What goes when space is short, and in which order.
#include "server/store/retention.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "server/store/sha256.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::server {
namespace {
namespace fs = std::filesystem;

class RetentionTest : public testing::Test {
 protected:
  void SetUp() override {
    jobs_ = std::make_unique<JobStore>(folder_ / "jobs.sqlite");
    blobs_ = std::make_unique<BlobStore>(folder_ / "blobs");
  }
  std::string blob(char letter) {
    const std::string bytes(1000, letter);
    const std::string name = blobs_->put(std::span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()));
    jobs_->addBlob(name, bytes.size(), "anna");
    return name;
  }
  fs::path task(const std::string& name, int age_s) {
    const fs::path file = folder_ / "tasks" / "ab" / name;
    fs::create_directories(file.parent_path());
    std::ofstream(file) << std::string(1000, 't');
    fs::last_write_time(file, fs::file_time_type::clock::now() - std::chrono::seconds(age_s));
    return file;
  }
  std::unique_ptr<Retention> retention(uint64_t max_bytes, double keep_s = -1) {
    return std::make_unique<Retention>(folder_ / "tasks", folder_ / "uploads", *blobs_, *jobs_,
                                       RetentionLimits{max_bytes, keep_s, 1e9, 1e9});
  }
  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::unique_ptr<JobStore> jobs_;
  std::unique_ptr<BlobStore> blobs_;
};

TEST_F(RetentionTest, OldTaskResultsGoFirstThenUnusedBlobs) {
  const fs::path old_task = task("old", 100), new_task = task("new", 1);
  const std::string a = blob('a');
  const auto store = retention(3000);
  EXPECT_EQ(store->storeBytes(), 3000u);
  EXPECT_TRUE(store->makeRoom(0));
  EXPECT_TRUE(fs::exists(old_task));
  EXPECT_TRUE(store->makeRoom(500));
  EXPECT_FALSE(fs::exists(old_task));
  EXPECT_TRUE(fs::exists(new_task));
  EXPECT_TRUE(store->makeRoom(3000));
  EXPECT_FALSE(fs::exists(new_task));
  EXPECT_FALSE(blobs_->size(a));
  EXPECT_FALSE(store->makeRoom(3001));
}

TEST_F(RetentionTest, WhatWasJustUsedStays) {
  const std::string a = blob('a');
  const auto store = retention(1000, 3600);
  EXPECT_FALSE(store->makeRoom(1));
  EXPECT_TRUE(blobs_->size(a));
}

TEST_F(RetentionTest, DiskAndDatabaseAreBroughtTogether) {
  const std::string known = blob('k'), lost = blob('l');
  blobs_->remove(lost);
  const std::string bytes = "left over";
  const std::string stray = blobs_->put(std::span(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()));
  retention(10000, 3600);
  EXPECT_EQ(jobs_->allBlobs(), std::vector<std::string>{known});
  EXPECT_FALSE(blobs_->size(stray));
}

}  // namespace
}  // namespace lightwell::server
