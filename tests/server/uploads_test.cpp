// Uploads: pieces, resumption, lies.
#include "server/store/uploads.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace lightwell::server {
namespace {
namespace fs = std::filesystem;

class UploadsTest : public testing::Test {
 protected:
  void SetUp() override {
    jobs_ = std::make_unique<JobStore>(folder_ / "jobs.sqlite");
    blobs_ = std::make_unique<BlobStore>(folder_ / "blobs");
    uploads_ = std::make_unique<Uploads>(folder_ / "uploads", *blobs_, *jobs_, UploadLimits{5000, 8000}, [this](uint64_t) { return room_; });
  }
  FailureId failureOf(const std::function<void()>& body) {
    try {
      body();
    } catch (const Failure& failure) {
      return failure.id;
    }
    return FailureId::internal;
  }
  test::TemporaryFolder temporary_;
  const fs::path folder_ = temporary_.path();
  std::unique_ptr<JobStore> jobs_;
  std::unique_ptr<BlobStore> blobs_;
  std::unique_ptr<Uploads> uploads_;
  bool room_ = true;
  const std::string data_ = std::string(1000, 'x'), name_ = sha256(data_);
};

TEST_F(UploadsTest, APieceAtATimeAcrossStreams) {
  {
    const auto upload = uploads_->begin("anna", name_, 1000, 0);
    upload->add(data_.substr(0, 400));
    EXPECT_FALSE(upload->finish().complete());
  }
  EXPECT_EQ(uploads_->find("anna", name_).received_bytes(), 400u);
  EXPECT_EQ(uploads_->find("bert", name_).received_bytes(), 0u) << "others start for themselves";
  {
    const auto upload = uploads_->begin("anna", name_, 1000, 300);  // going back is allowed
    upload->add(data_.substr(300));
    EXPECT_TRUE(upload->finish().complete());
  }
  EXPECT_EQ(blobs_->size(name_), 1000u);
  EXPECT_TRUE(uploads_->find("bert", name_).complete());
  EXPECT_EQ(uploads_->begin("bert", name_, 1000, 0), nullptr) << "nothing to send";
  EXPECT_EQ(uploads_->partialBytes(), 0u);
}

TEST_F(UploadsTest, Lies) {
  EXPECT_EQ(failureOf([&] {
              const auto upload = uploads_->begin("anna", std::string(64, '1'), 1000, 0);
              upload->add(data_);
              upload->finish();
            }), FailureId::hash_mismatch);
  EXPECT_EQ(uploads_->find("anna", std::string(64, '1')).received_bytes(), 0u) << "what came is forgotten";
  EXPECT_EQ(failureOf([&] { uploads_->begin("anna", name_, 10, 0)->add(data_); }), FailureId::upload_too_large);
  EXPECT_EQ(failureOf([&] { uploads_->begin("anna", name_, 1000, 1001); }), FailureId::invalid_request);
  EXPECT_EQ(failureOf([&] { uploads_->begin("anna", name_, 1000, 1000); }), FailureId::offset_mismatch);
  EXPECT_EQ(failureOf([&] { uploads_->begin("anna", name_, 5001, 0); }), FailureId::upload_too_large);
  EXPECT_EQ(failureOf([&] { uploads_->find("anna", "../" + std::string(61, '1')); }), FailureId::invalid_request);
}

TEST_F(UploadsTest, OneStreamAtATimeQuotaAndRoom) {
  const auto upload = uploads_->begin("anna", name_, 1000, 0);
  EXPECT_EQ(failureOf([&] { uploads_->begin("anna", name_, 1000, 0); }), FailureId::upload_in_use);
  EXPECT_NE(uploads_->begin("bert", name_, 1000, 0), nullptr);
  jobs_->addBlob(std::string(64, 'b'), 7500, "anna");
  EXPECT_EQ(failureOf([&] { uploads_->begin("anna", std::string(64, '2'), 1000, 0); }), FailureId::quota_exceeded);
  room_ = false;
  EXPECT_EQ(failureOf([&] { uploads_->begin("bert", std::string(64, '2'), 1000, 0); }), FailureId::store_full);
}

}  // namespace
}  // namespace lightwell::server
