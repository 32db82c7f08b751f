// Any sequence of calls to the service, over gRPC and a socket: handlers, streams, uploads, the job store. Where a request names a job or a file, a few short names stand for those
// that exist, so that the calls meet. The call `run` plays the worker. Every call ends, with a documented status, and no job is lost.
#include <grpcpp/grpcpp.h>

#include <chrono>

#include "server/rpc/bake_service.h"
#include "server/rpc/requests.h"
#include "server/store/sha256.h"
#include "tests/fuzz/call.h"
#include "tests/fuzz/temporary_file.h"

namespace lightwell::fuzz {
namespace {
using namespace lightwell::server;

constexpr size_t kMostCalls = 24;

/// One service for all inputs, emptied between them.
class Service {
 public:
  Service()
      : folder_(TemporaryFile("store").write("", 0).parent_path()),
        store_((std::filesystem::create_directories(folder_), folder_ / "jobs.sqlite")),
        blobs_(folder_ / "blobs"),
        jobs_(store_),
        retention_(folder_ / "tasks", folder_ / "uploads", blobs_, store_, {1 << 24, 1e9, 1e9, 1e9}),
        uploads_(folder_ / "uploads", blobs_, store_, {1 << 20, 1 << 22}, [this](uint64_t bytes) { return retention_.makeRoom(bytes); }),
        service_({jobs_, uploads_, blobs_, retention_, tokens_, {}, {8, 4, 4, 10}, {}}) {
    grpc::ServerBuilder builder;
    const std::string address = "unix:" + (folder_ / "socket").string();
    builder.AddListeningPort(address, grpc::InsecureServerCredentials());
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    stub_ = v1::BakeService::NewStub(grpc::CreateChannel(address, grpc::InsecureChannelCredentials()));
  }
  ~Service() {
    service_.shutDown();
    server_->Shutdown();
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  void run(const std::vector<Call>& calls) {
    for (const Call& call : calls) {
      const auto request = requestOf(call.method);
      if (request->ParsePartialFromString(call.request)) make(call.method, *request);
    }
    clear();
  }

 private:
  static std::unique_ptr<grpc::ClientContext> context() {
    auto context = std::make_unique<grpc::ClientContext>();
    context->set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    return context;
  }
  static void check(const grpc::Status& status) {
    require(status.error_code() != grpc::StatusCode::DEADLINE_EXCEEDED, "a call that ends");
    require(status.error_code() != grpc::StatusCode::INTERNAL && status.error_code() != grpc::StatusCode::UNKNOWN, ("a documented failure, not " + status.error_message()).c_str());
  }
  /// One character names a job that was made before; others are themselves.
  std::string job(const std::string& id) const { return id.size() == 1 && !made_.empty() ? made_[uint8_t(id[0]) % made_.size()] : id; }
  /// An upload of those bytes may call itself "" or one character.
  static std::string digest(const std::string& name, const std::string& data) { return name.size() <= 1 ? sha256(data) : name; }

  template <class Response, class Request>
  Response call(grpc::Status (v1::BakeService::Stub::*method)(grpc::ClientContext*, const Request&, Response*), const Request& request, grpc::Status* result = nullptr) {
    Response response;
    const grpc::Status status = (stub_.get()->*method)(context().get(), request, &response);
    check(status);
    if (result) *result = status;
    return response;
  }

  void make(Method method, google::protobuf::Message& message) {
    using Stub = v1::BakeService::Stub;
    switch (method) {
      case Method::info: call(&Stub::GetServerInfo, static_cast<v1::GetServerInfoRequest&>(message)); return;
      case Method::find_uploads: call(&Stub::FindUploads, static_cast<v1::FindUploadsRequest&>(message)); return;
      case Method::upload: upload(static_cast<v1::UploadRequest&>(message)); return;
      case Method::submit: submit(static_cast<v1::SubmitJobRequest&>(message)); return;
      case Method::get: named<v1::GetJobRequest>(message, &Stub::GetJob); return;
      case Method::cancel: named<v1::CancelJobRequest>(message, &Stub::CancelJob); return;
      case Method::remove: named<v1::DeleteJobRequest>(message, &Stub::DeleteJob); return;
      case Method::list: call(&Stub::ListJobs, static_cast<v1::ListJobsRequest&>(message)); return;
      case Method::watch: watch(static_cast<v1::WatchJobRequest&>(message)); return;
      case Method::download: download(static_cast<v1::DownloadResultRequest&>(message)); return;
      case Method::run: work(static_cast<v1::Job&>(message)); return;
    }
  }
  template <class Request, class Response>
  void named(google::protobuf::Message& message, grpc::Status (v1::BakeService::Stub::*method)(grpc::ClientContext*, const Request&, Response*)) {
    auto& request = static_cast<Request&>(message);
    request.set_id(job(request.id()));
    call(method, request);
  }
  void upload(v1::UploadRequest& request) {
    request.set_sha256(digest(request.sha256(), request.data()));
    if (request.size() < 16) request.set_size(request.data().size());
    const auto context = Service::context();
    v1::UploadState state;
    const auto writer = stub_->Upload(context.get(), &state);
    const std::string data = request.data();
    request.set_data(data.substr(0, data.size() / 2));
    if (writer->Write(request)) {
      request.set_data(data.substr(data.size() / 2));
      writer->Write(request);
    }
    writer->WritesDone();
    const grpc::Status status = writer->Finish();
    check(status);
    if (status.ok() && state.complete()) stored_.push_back(state.sha256());
  }
  void submit(v1::SubmitJobRequest& request) {
    for (auto& file : *request.mutable_spec()->mutable_files())
      if (file.sha256().size() <= 1 && !stored_.empty()) file.set_sha256(stored_[file.sha256().empty() ? 0 : uint8_t(file.sha256()[0]) % stored_.size()]);
    if (request.spec().scene().size() <= 1 && request.spec().files_size() > 0) request.mutable_spec()->set_scene(request.spec().files(0).name());
    grpc::Status status;
    const v1::Job job = call(&v1::BakeService::Stub::SubmitJob, request, &status);
    if (!status.ok()) return;
    require(jobs_.get(job.id(), "local") != nullptr, "a job that was accepted is there");
    made_.push_back(job.id());
  }
  /// The first state: of unfinished jobs there is no last one.
  void watch(v1::WatchJobRequest& request) {
    request.set_id(job(request.id()));
    const auto context = Service::context();
    const auto reader = stub_->WatchJob(context.get(), request);
    v1::Job state;
    if (reader->Read(&state)) context->TryCancel();
    check(reader->Finish());
  }
  void download(v1::DownloadResultRequest& request) {
    request.set_id(job(request.id()));
    const auto context = Service::context();
    const auto reader = stub_->DownloadResult(context.get(), request);
    v1::DownloadResultResponse piece;
    while (reader->Read(&piece)) {
    }
    check(reader->Finish());
  }
  /// What the scheduler does, with an ending that the input chose.
  void work(const v1::Job& wanted) {
    const auto next = jobs_.next();
    if (!next || !jobs_.start(next->id())) return;
    if (jobs_.answerFromCache(next->id())) return;
    Ending ending;
    ending.state = wanted.state() == v1::JOB_STATE_SUCCEEDED || wanted.state() == v1::JOB_STATE_CANCELLED ? wanted.state() : v1::JOB_STATE_FAILED;
    ending.error = wanted.error(), ending.progress = wanted.progress();
    if (ending.state == v1::JOB_STATE_SUCCEEDED) {
      const std::string bytes = wanted.result().report_json();
      const std::string name = blobs_.put({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
      store_.addBlob(name, bytes.size(), "local");
      ending.result.set_sha256(name), ending.result.set_size(bytes.size());
    }
    jobs_.finish(next->id(), ending);
  }
  void clear() {
    for (const std::string& id : made_) {
      store_.cancelQueued(id);
      store_.finish(id, {});
      store_.remove(id);
    }
    made_.clear(), stored_.clear();
    uploads_.removeStale(-1);
    for (const std::string& name : store_.allBlobs())
      if (store_.forgetBlob(name, nowMs() + 1000)) blobs_.remove(name);
  }

  const std::filesystem::path folder_;
  JobStore store_;
  BlobStore blobs_;
  Jobs jobs_;
  Retention retention_;
  Uploads uploads_;
  Tokens tokens_;
  BakeService service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::BakeService::Stub> stub_;
  std::vector<std::string> made_, stored_;
};

}  // namespace
}  // namespace lightwell::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static lightwell::fuzz::Service service;
  lightwell::fuzz::Feed feed(data, size);
  service.run(lightwell::fuzz::callsOf(feed, lightwell::fuzz::kMostCalls));
  return 0;
}
