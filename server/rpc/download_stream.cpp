// BakeService.DownloadResult: the container, piece by piece, as fast as the client takes it.
#include <fcntl.h>
#include <unistd.h>

#include "server/rpc/bake_service.h"

namespace lightwell::server {
namespace {

constexpr size_t kPieceBytes = 1 << 20;

class DownloadStream final : public grpc::ServerWriteReactor<v1::DownloadResultResponse> {
 public:
  /// Owns `fd`.
  DownloadStream(int fd, const v1::JobResult& result, uint64_t offset) : fd_(fd), size_(result.size()), offset_(offset) {
    message_.set_size(size_);
    message_.set_sha256(result.sha256());
    next();
  }
  ~DownloadStream() override { close(fd_); }
  void OnWriteDone(bool ok) override {
    if (!ok) return Finish(grpc::Status::CANCELLED);
    if (offset_ == size_) return Finish(grpc::Status::OK);
    message_.Clear();
    next();
  }
  void OnDone() override { delete this; }

 private:
  void next() {
    std::string& data = *message_.mutable_data();
    data.resize(size_t(std::min<uint64_t>(kPieceBytes, size_ - offset_)));
    const ssize_t got = data.empty() ? 0 : pread(fd_, data.data(), data.size(), off_t(offset_));
    if (got < 0 || size_t(got) != data.size()) return Finish({grpc::StatusCode::DATA_LOSS, "the container cannot be read"});
    offset_ += uint64_t(got);
    StartWrite(&message_);
  }
  const int fd_;
  const uint64_t size_;
  uint64_t offset_;
  v1::DownloadResultResponse message_;
};

}  // namespace

grpc::ServerWriteReactor<v1::DownloadResultResponse>* makeDownloadStream(ServiceParts& parts, grpc::CallbackServerContext*,
                                                                         const v1::DownloadResultRequest& request,
                                                                         const std::string& client) {
  const JobPtr job = parts.jobs.get(request.id(), client);
  if (job->state() == v1::JOB_STATE_QUEUED || job->state() == v1::JOB_STATE_RUNNING)
    throw Failure(FailureId::job_unfinished, "the job is not finished");
  if (job->state() != v1::JOB_STATE_SUCCEEDED) throw Failure(FailureId::no_result, "the job has no container: " + job->error().message());
  if (request.offset() > job->result().size()) throw Failure(FailureId::offset_mismatch, "the offset lies behind the container's end");
  const int fd = open(parts.blobs.fileOf(job->result().sha256()).c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) throw Failure(FailureId::internal, "the container is missing in the store");
  return new DownloadStream(fd, job->result(), request.offset());
}

}  // namespace lightwell::server
