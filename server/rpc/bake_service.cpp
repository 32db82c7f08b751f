#include "server/rpc/bake_service.h"

#include <chrono>

#include "server/rpc/requests.h"
#include "server/rpc/status.h"
#include "server/job/job_state.h"

namespace lightwell::server {
namespace {

constexpr unsigned kQueueThreads = 8;
constexpr size_t kMostNamesPerQuery = 10000;

template <class Reactor>
Reactor* refused(const Failure& failure) {
  class Refused : public Reactor {
   public:
    explicit Refused(const grpc::Status& status) { this->Finish(status); }
    void OnDone() override { delete this; }
  };
  return new Refused(statusOf(failure));
}

int64_t parsePageToken(const std::string& token) {
  int64_t before = 0;
  for (const char c : token) {
    if (c < '0' || c > '9' || token.size() > 18) throw Failure(FailureId::invalid_request, "the page token is none of ours");
    before = before * 10 + (c - '0');
  }
  return before;
}

}  // namespace

grpc::Status finished(grpc::CallbackServerContext* context, grpc::Status status) {
  if (!status.ok()) {
    v1::ErrorDetail detail;
    if (detail.ParseFromString(status.error_details())) context->AddTrailingMetadata("lightwell-error-id", detail.id());
  }
  return status;
}

/// One watch: holds the newest state until the last one is sent. States may be skipped, never the final one.
class WatchStream final : public grpc::ServerWriteReactor<v1::Job>, public JobWatcher, public OpenStream,
                          public std::enable_shared_from_this<WatchStream> {
 public:
  WatchStream(BakeService& service, grpc::CallbackServerContext* context, std::string id)
      : service_(service), context_(context), id_(std::move(id)) {}

  void begin(const std::string& client) {
    service_.queue_.add([self = shared_from_this(), client] {
      grpc::Status status = guarded([&] { self->jobChanged(self->service_.parts_.jobs.watch(self->id_, client, self)); });
      if (!status.ok()) self->finish(std::move(status));
      // If the client left in the meantime, OnDone() came before there was anything to take back.
      std::unique_lock lock(self->mutex_);
      const bool finished = self->finished_;
      lock.unlock();
      if (finished) self->service_.parts_.jobs.unwatch(self->id_, self);
    });
  }
  void jobChanged(const JobPtr& job) override {
    std::lock_guard lock(mutex_);
    if (finished_ || (newest_ && isFinal(newest_->state()))) return;
    newest_ = job;
    fresh_ = true;
    writeNewest();
  }
  void end(const Failure& why) override { finish(statusOf(why)); }
  void OnWriteDone(bool ok) override {
    const auto keep = shared_from_this();
    std::lock_guard lock(mutex_);
    writing_ = false;
    if (!ok) return finishLocked(grpc::Status::CANCELLED);
    if (end_) return finishLocked(*end_);
    if (fresh_) return writeNewest();
    if (isFinal(newest_->state())) finishLocked(grpc::Status::OK);
  }
  void OnCancel() override { finish(grpc::Status::CANCELLED); }
  void OnDone() override {
    const auto keep = shared_from_this();
    service_.parts_.jobs.unwatch(id_, keep);
    --service_.watches_;
    service_.close(keep);
  }

 private:
  void writeNewest() {
    if (writing_ || finished_) return;
    fresh_ = false;
    writing_ = true;
    sending_ = *newest_;
    StartWrite(&sending_);
  }
  void finish(grpc::Status status) {
    const auto keep = shared_from_this();
    std::lock_guard lock(mutex_);
    if (writing_)
      end_ = std::move(status);  // once the write has ended
    else
      finishLocked(std::move(status));
  }
  void finishLocked(grpc::Status status) {
    if (std::exchange(finished_, true)) return;
    Finish(finished(context_, std::move(status)));
  }

  BakeService& service_;
  grpc::CallbackServerContext* context_;
  const std::string id_;
  std::mutex mutex_;
  JobPtr newest_;
  v1::Job sending_;
  std::optional<grpc::Status> end_;
  bool fresh_ = false, writing_ = false, finished_ = false;
};

BakeService::BakeService(ServiceParts parts) : parts_(std::move(parts)), queue_(kQueueThreads) {}
BakeService::~BakeService() = default;

std::string BakeService::clientOf(const grpc::CallbackServerContext& context) const {
  if (shutting_down_) throw Failure(FailureId::shutting_down, "the server is shutting down");
  const auto header = context.client_metadata().find("authorization");
  const std::string_view value = header == context.client_metadata().end()
                                     ? std::string_view()
                                     : std::string_view(header->second.data(), header->second.size());
  if (auto client = parts_.tokens.authorize(value)) return *client;
  throw Failure(FailureId::unauthenticated, value.empty() ? "this server wants a token" : "the token is not known here");
}

grpc::ServerUnaryReactor* BakeService::answer(grpc::CallbackServerContext* context, std::function<void(const std::string&)> body) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  queue_.add([this, context, reactor, body = std::move(body)] {
    reactor->Finish(finished(context, guarded([&] { body(clientOf(*context)); })));
  });
  return reactor;
}

void BakeService::open(const std::shared_ptr<OpenStream>& stream) {
  std::lock_guard lock(mutex_);
  streams_.insert(stream);
}
void BakeService::close(const std::shared_ptr<OpenStream>& stream) {
  std::lock_guard lock(mutex_);
  streams_.erase(stream);
}

void BakeService::shutDown() {
  shutting_down_ = true;
  std::unique_lock lock(mutex_);
  const auto streams = streams_;
  lock.unlock();
  for (const auto& stream : streams) stream->end(Failure(FailureId::shutting_down, "the server is shutting down"));
}

void BakeService::tick() {
  std::unique_lock lock(mutex_);
  const auto streams = streams_;
  lock.unlock();
  for (const auto& stream : streams) stream->tick();
}

grpc::ServerUnaryReactor* BakeService::GetServerInfo(grpc::CallbackServerContext* context, const v1::GetServerInfoRequest*,
                                                     v1::ServerInfo* response) {
  return answer(context, [this, response](const std::string& client) {
    *response = parts_.info;
    response->set_client(client);
    response->set_store_bytes(parts_.retention.storeBytes());
    const auto counts = parts_.jobs.counts();
    const auto count = [&](v1::JobState state) { return counts.contains(state) ? uint32_t(counts.at(state)) : 0; };
    response->set_queued_jobs(count(v1::JOB_STATE_QUEUED));
    response->set_running_jobs(count(v1::JOB_STATE_RUNNING));
  });
}

grpc::ServerUnaryReactor* BakeService::FindUploads(grpc::CallbackServerContext* context, const v1::FindUploadsRequest* request,
                                                   v1::FindUploadsResponse* response) {
  return answer(context, [this, request, response](const std::string& client) {
    if (size_t(request->sha256_size()) > kMostNamesPerQuery)
      throw Failure(FailureId::invalid_request, "at most " + std::to_string(kMostNamesPerQuery) + " files at once");
    for (const auto& sha256 : request->sha256()) *response->add_uploads() = parts_.uploads.find(client, sha256);
  });
}

grpc::ServerReadReactor<v1::UploadRequest>* BakeService::Upload(grpc::CallbackServerContext* context, v1::UploadState* response) {
  try {
    const std::string client = clientOf(*context);
    if (uploads_ >= parts_.limits.max_uploads) throw Failure(FailureId::too_many_streams, "too many uploads at once; try again");
    return makeUploadStream(*this, parts_, context, client, response);
  } catch (const Failure& failure) {
    context->AddTrailingMetadata("lightwell-error-id", name(failure.id));
    return refused<grpc::ServerReadReactor<v1::UploadRequest>>(failure);
  }
}

grpc::ServerUnaryReactor* BakeService::SubmitJob(grpc::CallbackServerContext* context, const v1::SubmitJobRequest* request,
                                                 v1::Job* response) {
  const auto begin = std::chrono::steady_clock::now();
  return answer(context, [this, request, response, begin](const std::string& client) {
    Submission submission{.client = client, .spec = request->spec(), .idempotency_key = request->idempotency_key(), .request_key = {},
                          .max_unfinished_jobs = parts_.limits.max_unfinished_jobs};
    if (submission.idempotency_key.size() > kMaxIdempotencyKeyBytes)
      throw Failure(FailureId::invalid_request, "the idempotency key has more than " + std::to_string(kMaxIdempotencyKeyBytes) + " bytes");
    checkSpec(submission.spec);
    submission.request_key = requestKey(submission.spec, parts_.info.version());
    bool created = false;
    *response = *parts_.jobs.submit(submission, created);
    if (parts_.submitted) parts_.submitted(std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  });
}

grpc::ServerUnaryReactor* BakeService::GetJob(grpc::CallbackServerContext* context, const v1::GetJobRequest* request, v1::Job* response) {
  return answer(context, [this, request, response](const std::string& client) { *response = *parts_.jobs.get(request->id(), client); });
}

grpc::ServerUnaryReactor* BakeService::ListJobs(grpc::CallbackServerContext* context, const v1::ListJobsRequest* request,
                                                v1::ListJobsResponse* response) {
  return answer(context, [this, request, response](const std::string& client) {
    if (request->page_size() > kMaxPageSize)
      throw Failure(FailureId::invalid_request, "a page has at most " + std::to_string(kMaxPageSize) + " jobs");
    std::vector<v1::JobState> states;
    for (const int state : request->states()) {
      if (state < v1::JOB_STATE_QUEUED || state > v1::JOB_STATE_CANCELLED) throw Failure(FailureId::invalid_request, "no such state");
      states.push_back(v1::JobState(state));
    }
    const auto page = parts_.jobs.list(client, states, request->label(), parsePageToken(request->page_token()),
                                       request->page_size() ? request->page_size() : kDefaultPageSize);
    for (const auto& job : page.jobs) *response->add_jobs() = *job;
    if (page.next) response->set_next_page_token(std::to_string(page.next));
  });
}

grpc::ServerWriteReactor<v1::Job>* BakeService::WatchJob(grpc::CallbackServerContext* context, const v1::WatchJobRequest* request) {
  try {
    const std::string client = clientOf(*context);
    if (watches_ >= parts_.limits.max_watches) throw Failure(FailureId::too_many_streams, "too many watches at once; poll instead");
    const auto stream = std::make_shared<WatchStream>(*this, context, request->id());
    ++watches_;
    open(stream);
    stream->begin(client);
    return stream.get();
  } catch (const Failure& failure) {
    context->AddTrailingMetadata("lightwell-error-id", name(failure.id));
    return refused<grpc::ServerWriteReactor<v1::Job>>(failure);
  }
}

grpc::ServerUnaryReactor* BakeService::CancelJob(grpc::CallbackServerContext* context, const v1::CancelJobRequest* request,
                                                 v1::Job* response) {
  return answer(context, [this, request, response](const std::string& client) { *response = *parts_.jobs.cancel(request->id(), client); });
}

grpc::ServerUnaryReactor* BakeService::DeleteJob(grpc::CallbackServerContext* context, const v1::DeleteJobRequest* request,
                                                 v1::DeleteJobResponse*) {
  return answer(context, [this, request](const std::string& client) { parts_.jobs.remove(request->id(), client); });
}

grpc::ServerWriteReactor<v1::DownloadResultResponse>* BakeService::DownloadResult(grpc::CallbackServerContext* context,
                                                                                  const v1::DownloadResultRequest* request) {
  try {
    return makeDownloadStream(parts_, context, *request, clientOf(*context));
  } catch (const Failure& failure) {
    context->AddTrailingMetadata("lightwell-error-id", name(failure.id));
    return refused<grpc::ServerWriteReactor<v1::DownloadResultResponse>>(failure);
  }
}

}  // namespace lightwell::server
