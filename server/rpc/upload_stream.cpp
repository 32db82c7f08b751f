// BakeService.Upload: messages are written from the work queue, one at a time.
#include <chrono>

#include "server/rpc/bake_service.h"
#include "server/rpc/requests.h"
#include "server/rpc/status.h"

namespace lightwell::server {

class UploadStream final : public grpc::ServerReadReactor<v1::UploadRequest>, public OpenStream,
                           public std::enable_shared_from_this<UploadStream> {
 public:
  UploadStream(BakeService& service, ServiceParts& parts, grpc::CallbackServerContext* context, std::string client, v1::UploadState* response)
      : service_(service), parts_(parts), context_(context), client_(std::move(client)), response_(response) {}

  void begin() { readMore(); }

  void OnReadDone(bool ok) override {
    service_.queue_.add([self = shared_from_this(), ok] {
      bool complete = false;
      const grpc::Status status = guarded([&] { complete = ok ? self->take() : self->complete(); });
      if (!status.ok() || complete) return self->finish(status);
      self->readMore();
    });
  }
  void end(const Failure& why) override { finish(statusOf(why)); }
  void tick() override {
    const auto idle = std::chrono::steady_clock::now().time_since_epoch() - last_read_.load();
    if (reading_ && std::chrono::duration<double>(idle).count() > parts_.limits.upload_idle_s)
      end(Failure(FailureId::upload_stalled, "nothing came for too long; what came is kept, ask where to go on"));
  }
  void OnCancel() override { finish(grpc::Status::CANCELLED); }
  void OnDone() override {
    const auto keep = shared_from_this();
    --service_.uploads_;
    service_.close(keep);
  }

 private:
  /// True when nothing more is needed.
  bool take() {
    if (message_.data().size() > kMaxUploadMessageBytes)
      throw Failure(FailureId::invalid_request, "a message carries at most " + std::to_string(kMaxUploadMessageBytes) + " bytes of data");
    if (!begun_) {
      begun_ = true;
      sha256_ = message_.sha256();
      upload_ = parts_.uploads.begin(client_, sha256_, message_.size(), message_.offset());
      if (!upload_) {  // it is there already
        *response_ = parts_.uploads.find(client_, sha256_);
        return true;
      }
    }
    upload_->add(message_.data());
    return false;
  }
  bool complete() {
    if (!begun_) throw Failure(FailureId::invalid_request, "the upload has no first message");
    *response_ = upload_->finish();
    upload_.reset();
    return true;
  }
  void readMore() {
    const auto keep = shared_from_this();
    std::lock_guard lock(mutex_);
    if (finished_) return;
    last_read_ = std::chrono::steady_clock::now().time_since_epoch();
    reading_ = true;
    StartRead(&message_);
  }
  void finish(grpc::Status status) {
    const auto keep = shared_from_this();
    std::lock_guard lock(mutex_);
    if (std::exchange(finished_, true)) return;
    Finish(finished(context_, std::move(status)));
  }

  BakeService& service_;
  ServiceParts& parts_;
  grpc::CallbackServerContext* context_;
  const std::string client_;
  v1::UploadState* response_;
  v1::UploadRequest message_;
  std::string sha256_;
  std::unique_ptr<server::Upload> upload_;
  bool begun_ = false;
  std::atomic<bool> reading_{false};
  std::atomic<std::chrono::steady_clock::duration> last_read_{};
  std::mutex mutex_;
  bool finished_ = false;
};

grpc::ServerReadReactor<v1::UploadRequest>* makeUploadStream(BakeService& service, ServiceParts& parts,
                                                             grpc::CallbackServerContext* context, const std::string& client,
                                                             v1::UploadState* response) {
  const auto stream = std::make_shared<UploadStream>(service, parts, context, client, response);
  ++service.uploads_;
  service.open(stream);
  stream->begin();
  return stream.get();
}

}  // namespace lightwell::server
