// Jobs on disk: states, turns, idempotency, answers, recovery.
#include "server/store/job_store.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "server/failure.h"
#include "server/job/job_state.h"
#include "tests/support/temporary_folder.h"

namespace lightwell::server {
namespace {
namespace fs = std::filesystem;

class JobStoreTest : public testing::Test {
 protected:
  void SetUp() override {
    store_ = std::make_unique<JobStore>(folder_ / "jobs.sqlite");
    store_->addBlob(kScene, 10, "anna");
  }
  std::string add(const std::string& client, const std::string& request_key, int priority = 0, const std::string& key = "") {
    Submission submission{.client = client, .spec = {}, .idempotency_key = key, .request_key = request_key, .max_unfinished_jobs = 100};
    auto& file = *submission.spec.add_files();
    file.set_name("room.glb");
    file.set_sha256(kScene);
    file.set_size(10);
    submission.spec.set_priority(priority);
    return store_->submit(submission).job.id();
  }
  std::string takeNext() {
    const auto job = store_->next();
    if (!job || !store_->start(job->id())) return "";
    return job->id();
  }
  void succeed(const std::string& id, bool reusable = true) {
    store_->addBlob(kContainer, 20, "");
    Ending ending{.state = v1::JOB_STATE_SUCCEEDED, .reusable = reusable};
    ending.result.set_sha256(kContainer);
    ending.result.set_size(20);
    ASSERT_TRUE(store_->finish(id, ending));
  }
  v1::JobState state(const std::string& id) { return store_->get(id)->state(); }
  const std::string kScene = std::string(64, 'a'), kContainer = std::string(64, 'c');
  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::unique_ptr<JobStore> store_;
};

TEST_F(JobStoreTest, OnlyTheTablesTransitionsHappen) {
  const v1::JobState all[] = {v1::JOB_STATE_QUEUED, v1::JOB_STATE_RUNNING, v1::JOB_STATE_SUCCEEDED, v1::JOB_STATE_FAILED, v1::JOB_STATE_CANCELLED};
  for (const auto from : all)
    for (const auto to : all)
      if (isFinal(from) || from == to) {
        EXPECT_FALSE(isTransition(from, to));
      }
  const std::string id = add("anna", "r1");
  EXPECT_FALSE(store_->finish(id, {.state = v1::JOB_STATE_QUEUED}));
  EXPECT_TRUE(store_->start(id));
  EXPECT_FALSE(store_->start(id));
  EXPECT_TRUE(store_->finish(id, {.state = v1::JOB_STATE_CANCELLED}));
  EXPECT_FALSE(store_->finish(id, {.state = v1::JOB_STATE_SUCCEEDED}));
  EXPECT_FALSE(store_->cancelQueued(id));
}

TEST_F(JobStoreTest, AnIdempotencyKeyMakesOneJobPerClient) {
  const std::string first = add("anna", "r1", 0, "key");
  EXPECT_EQ(add("anna", "r2", 0, "key"), first);
  EXPECT_NE(add("bert", "r1", 0, "key"), first);
  EXPECT_NE(add("anna", "r1"), add("anna", "r1"));
}

TEST_F(JobStoreTest, PriorityThenTurnsThenAge) {
  const std::string a1 = add("anna", "1"), a2 = add("anna", "2"), a3 = add("anna", "3"), b1 = add("bert", "4"), b2 = add("bert", "5");
  const std::string urgent = add("anna", "6", 5);
  EXPECT_EQ(takeNext(), urgent);
  EXPECT_EQ(takeNext(), b1) << "anna has one running";
  EXPECT_EQ(takeNext(), a1) << "one each: anna's start is longer ago";
  EXPECT_EQ(takeNext(), b2);
  EXPECT_EQ(takeNext(), a2);
  EXPECT_EQ(takeNext(), a3);
  EXPECT_EQ(takeNext(), "");
}

TEST_F(JobStoreTest, EqualRequestsRunOnce) {
  const std::string a = add("anna", "same"), b = add("bert", "same"), other = add("bert", "other");
  EXPECT_EQ(takeNext(), a);
  EXPECT_EQ(takeNext(), other);
  EXPECT_EQ(takeNext(), "") << "it waits for the answer";
  succeed(a);
  EXPECT_TRUE(store_->answerFromCache(b));
  EXPECT_EQ(state(b), v1::JOB_STATE_SUCCEEDED);
  EXPECT_TRUE(store_->get(b)->result().from_cache());
  EXPECT_EQ(state(add("carl", "same")), v1::JOB_STATE_SUCCEEDED) << "at once";
}

TEST_F(JobStoreTest, AnswersThatDependOnTimeAreNotReused) {
  const std::string a = add("anna", "same");
  takeNext();
  succeed(a, false);
  EXPECT_EQ(state(add("anna", "same")), v1::JOB_STATE_QUEUED);
}

TEST_F(JobStoreTest, WhatRanIsQueuedAgainByTheNextProcess) {
  const std::string a = add("anna", "1"), b = add("anna", "2"), c = add("anna", "3");
  takeNext(), takeNext();
  store_->requestCancel(b);
  store_ = std::make_unique<JobStore>(folder_ / "jobs.sqlite");
  EXPECT_EQ(store_->recover(), 1u);
  EXPECT_EQ(state(a), v1::JOB_STATE_QUEUED);
  EXPECT_EQ(state(b), v1::JOB_STATE_CANCELLED) << "that was asked for before";
  EXPECT_EQ(state(c), v1::JOB_STATE_QUEUED);
  EXPECT_EQ(store_->get(a)->attempts(), 1u);
}

TEST_F(JobStoreTest, Limits) {
  Submission submission{.client = "anna", .spec = {}, .idempotency_key = {}, .request_key = "r", .max_unfinished_jobs = 1};
  submission.spec.add_files()->set_sha256(std::string(64, 'f'));
  try {
    store_->submit(submission);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.id, FailureId::missing_file);
  }
  submission.spec.clear_files();
  store_->submit(submission);
  try {
    store_->submit(submission);
    FAIL();
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.id, FailureId::too_many_jobs);
  }
}

TEST_F(JobStoreTest, BlobsStayWhileTheyAreNeeded) {
  const int64_t later = nowMs() + 1000000;
  const auto unreferenced = [&] {
    std::string names;
    for (const auto& blob : store_->unreferenced(later)) names += blob.sha256[0];
    return names;
  };
  EXPECT_EQ(unreferenced(), "a");
  const std::string id = add("anna", "r");
  EXPECT_EQ(unreferenced(), "");
  EXPECT_FALSE(store_->forgetBlob(kScene, later));
  takeNext();
  succeed(id);
  EXPECT_EQ(unreferenced(), "a") << "the input of a finished job; its container stays";
  EXPECT_TRUE(store_->remove(id));
  EXPECT_EQ(unreferenced(), "ac");
  EXPECT_TRUE(store_->forgetBlob(kContainer, later));
  EXPECT_EQ(state(add("anna", "r")), v1::JOB_STATE_QUEUED) << "no answer without its container";
  EXPECT_TRUE(store_->unreferenced(0).empty()) << "just used";
}

TEST_F(JobStoreTest, PagesAreCompleteAndDisjoint) {
  std::vector<std::string> ids;
  for (int i = 0; i < 7; ++i) ids.push_back(add(i % 2 ? "anna" : "bert", std::to_string(i)));
  std::vector<std::string> listed;
  int64_t before = 0;
  do {
    const auto page = store_->list("", {}, "", before, 3);
    for (const auto& job : page.jobs) listed.push_back(job.id());
    before = page.next;
  } while (before);
  std::reverse(listed.begin(), listed.end());
  EXPECT_EQ(listed, ids);
  EXPECT_EQ(store_->list("anna", {}, "", 0, 100).jobs.size(), 3u);
  EXPECT_EQ(store_->list("", {v1::JOB_STATE_RUNNING}, "", 0, 100).jobs.size(), 0u);
}

}  // namespace
}  // namespace lightwell::server
