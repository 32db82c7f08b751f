#include "server/client/client.h"

#include <grpcpp/grpcpp.h>
#include <sys/random.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>
#include <thread>

#include "lightwell/v1/service.grpc.pb.h"
#include "precompute/core/error.h"
#include "server/store/sha256.h"

namespace lightwell::server {
namespace {

using Clock = std::chrono::steady_clock;
constexpr size_t kPieceBytes = 1 << 20;
constexpr auto kBetweenTries = std::chrono::milliseconds(200);
constexpr double kCall_s = 60;  // for one unary call

std::string readFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw UsageError("cannot read " + file.string());
  return text.str();
}

std::string readToken(const std::filesystem::path& file) {
  std::istringstream lines(readFile(file));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string token;
    for (std::string word; words >> word;) token = word;
    if (!token.empty()) return token;
  }
  throw UsageError("there is no token in " + file.string());
}

bool isLocal(const std::string& server) {
  return server.starts_with("127.") || server.starts_with("localhost:") || server.starts_with("[::1]");
}

std::string randomKey() {
  uint64_t words[2] = {};
  if (getrandom(words, sizeof words, 0) != sizeof words) throw std::runtime_error("the system gives no random numbers");
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(words[0]), static_cast<unsigned long long>(words[1]));
  return text;
}

/// Cancels a call when the flag is set: gRPC's blocking calls do not poll.
class CallWatchdog {
 public:
  CallWatchdog(grpc::ClientContext& context, const CancelFlag& cancel)
      : thread_([this, &context, &cancel] {
          while (!done_ && !cancel.cancelled()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
          if (!done_) context.TryCancel();
        }) {}
  ~CallWatchdog() {
    done_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> done_{false};
  std::thread thread_;
};

}  // namespace

struct Client::Connection {
  Connection(const ClientOptions& options, const CancelFlag& cancel) : options(options), cancel(cancel) {
    if (options.token_file) token = readToken(*options.token_file);
    const bool tls = options.tls_ca || options.tls_certificate;
    if (!token.empty() && !tls && !isLocal(options.server))
      throw UsageError("will not send a token to " + options.server + " without TLS: give --tls-ca FILE");
    std::shared_ptr<grpc::ChannelCredentials> credentials = grpc::InsecureChannelCredentials();
    if (tls) {
      grpc::SslCredentialsOptions ssl;
      if (options.tls_ca) ssl.pem_root_certs = readFile(*options.tls_ca);
      if (options.tls_certificate) ssl.pem_cert_chain = readFile(*options.tls_certificate);
      if (options.tls_key) ssl.pem_private_key = readFile(*options.tls_key);
      credentials = grpc::SslCredentials(ssl);
    }
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 100);
    arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1000);
    arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 1000);
    arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, 20000);
    arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
    stub = v1::BakeService::NewStub(grpc::CreateCustomChannel(options.server, credentials, arguments));
  }

  void prepare(grpc::ClientContext& context) const {
    if (!token.empty()) context.AddMetadata("authorization", "Bearer " + token);
  }

  [[noreturn]] void fail(const grpc::Status& status) const {
    cancel.check();
    v1::ErrorDetail detail;
    detail.ParseFromString(status.error_details());
    const bool unreachable = status.error_code() == grpc::StatusCode::UNAVAILABLE && detail.id() != "shutting_down";
    if (unreachable)
      throw ServiceError("", "the server at " + options.server + " cannot be reached (" + status.error_message() + ")" +
                                 (isLocal(options.server) ? "; lightwelld --data DIR starts one" : ""), true);
    throw ServiceError(detail.id(), options.server + ": " + status.error_message(), false);
  }

  /// Runs `call` until it gets an answer. `call` sets the time of the last contact while it hears from the server.
  template <class Call>
  void repeat(const Call& call) {
    auto last_contact = Clock::now();
    bool waiting = false;
    while (true) {
      cancel.check();
      grpc::ClientContext context;
      prepare(context);
      grpc::Status status;
      {
        const CallWatchdog watchdog(context, cancel);
        status = call(context, last_contact);
      }
      // A server that ends cuts calls off with one or the other,
      const bool cut_off = status.error_code() == grpc::StatusCode::UNAVAILABLE || status.error_code() == grpc::StatusCode::CANCELLED;
      if (!cut_off) {
        reached = true;
        if (status.ok()) return;
        fail(status);
      }
      cancel.check();  // or this side did
      if (!waiting && options.waiting) options.waiting("waiting for a server at " + options.server + " (" + status.error_message() + ")");
      waiting = true;
      const double silent_s = std::chrono::duration<double>(Clock::now() - last_contact).count();
      if (silent_s > (reached ? options.watch_patience_s : options.patience_s)) fail(status);
      std::this_thread::sleep_for(kBetweenTries);
    }
  }

  template <class Request, class Response>
  Response unary(grpc::Status (v1::BakeService::Stub::*method)(grpc::ClientContext*, const Request&, Response*), const Request& request) {
    Response response;
    repeat([&](grpc::ClientContext& context, Clock::time_point&) {
      context.set_deadline(std::chrono::system_clock::now() + std::chrono::duration_cast<std::chrono::system_clock::duration>(
                                                                  std::chrono::duration<double>(kCall_s)));
      return (stub.get()->*method)(&context, request, &response);
    });
    return response;
  }

  const ClientOptions options;
  const CancelFlag& cancel;
  std::string token;
  bool reached = false;
  std::unique_ptr<v1::BakeService::Stub> stub;
};

Client::Client(const ClientOptions& options, const CancelFlag& cancel) : connection_(std::make_unique<Connection>(options, cancel)) {}
Client::~Client() = default;

v1::ServerInfo Client::info() { return connection_->unary(&v1::BakeService::Stub::GetServerInfo, v1::GetServerInfoRequest()); }

void Client::upload(const std::vector<LocalFile>& files, const std::function<void(uint64_t, uint64_t)>& progress) {
  uint64_t total = 0, before = 0;
  for (const auto& file : files) total += file.size;
  for (const auto& file : files) {
    v1::FindUploadsRequest query;
    query.add_sha256(file.sha256);
    // Another client may be sending the same file: whoever is first.
    for (bool complete = false; !complete;) {
      connection_->cancel.check();
      const auto known = connection_->unary(&v1::BakeService::Stub::FindUploads, query);
      if (known.uploads(0).complete()) break;
      const uint64_t offset = std::min(known.uploads(0).received_bytes(), file.size);
      v1::UploadState state;
      bool in_use = false;
      connection_->repeat([&](grpc::ClientContext& context, Clock::time_point& last_contact) {
        std::ifstream in(file.path, std::ios::binary);
        in.seekg(std::streamoff(offset));
        const auto writer = connection_->stub->Upload(&context, &state);
        v1::UploadRequest message;
        message.set_sha256(file.sha256);
        message.set_size(file.size);
        message.set_offset(offset);
        for (uint64_t sent = offset;;) {
          std::string& data = *message.mutable_data();
          data.resize(size_t(std::min<uint64_t>(kPieceBytes, file.size - sent)));
          in.read(data.data(), std::streamsize(data.size()));
          if (!in || !writer->Write(message)) break;
          sent += data.size();
          last_contact = Clock::now();
          if (progress) progress(before + sent, total);
          message.Clear();
          if (sent == file.size) break;
        }
        if (!in) {
          context.TryCancel();
          writer->Finish();
          throw InputError(file.path.string(), "", "changed while it was being sent");
        }
        writer->WritesDone();
        const grpc::Status status = writer->Finish();
        in_use = status.error_code() == grpc::StatusCode::ABORTED;
        // Cut off, or overtaken by another stream: ask anew where to go on.
        const bool ask_anew = in_use || status.error_code() == grpc::StatusCode::OUT_OF_RANGE ||
                              status.error_code() == grpc::StatusCode::UNAVAILABLE;
        return ask_anew ? grpc::Status::OK : status;
      });
      complete = state.complete();
      if (in_use) std::this_thread::sleep_for(kBetweenTries);
    }
    before += file.size;
    if (progress) progress(before, total);
  }
}

v1::Job Client::submit(const v1::JobSpec& spec) {
  v1::SubmitJobRequest request;
  *request.mutable_spec() = spec;
  request.set_idempotency_key(randomKey());
  return connection_->unary(&v1::BakeService::Stub::SubmitJob, request);
}

v1::Job Client::get(const std::string& id) {
  v1::GetJobRequest request;
  request.set_id(id);
  return connection_->unary(&v1::BakeService::Stub::GetJob, request);
}

v1::ListJobsResponse Client::list(const v1::ListJobsRequest& request) {
  return connection_->unary(&v1::BakeService::Stub::ListJobs, request);
}

v1::Job Client::watch(const std::string& id, const std::function<void(const v1::Job&)>& changed) {
  v1::WatchJobRequest request;
  request.set_id(id);
  v1::Job job;
  connection_->repeat([&](grpc::ClientContext& context, Clock::time_point& last_contact) {
    const auto reader = connection_->stub->WatchJob(&context, request);
    while (reader->Read(&job)) {
      connection_->reached = true;
      last_contact = Clock::now();
      if (changed) changed(job);
    }
    return reader->Finish();
  });
  return job;
}

v1::Job Client::cancel(const std::string& id) {
  v1::CancelJobRequest request;
  request.set_id(id);
  return connection_->unary(&v1::BakeService::Stub::CancelJob, request);
}

void Client::remove(const std::string& id) {
  v1::DeleteJobRequest request;
  request.set_id(id);
  connection_->unary(&v1::BakeService::Stub::DeleteJob, request);
}

std::vector<uint8_t> Client::download(const std::string& id, const std::function<void(uint64_t, uint64_t)>& progress) {
  std::vector<uint8_t> bytes;
  std::string sha256;
  connection_->repeat([&](grpc::ClientContext& context, Clock::time_point& last_contact) {
    v1::DownloadResultRequest request;
    request.set_id(id);
    request.set_offset(bytes.size());
    const auto reader = connection_->stub->DownloadResult(&context, request);
    v1::DownloadResultResponse piece;
    uint64_t size = 0;
    while (reader->Read(&piece)) {
      last_contact = Clock::now();
      if (!piece.sha256().empty()) sha256 = piece.sha256(), size = piece.size();
      bytes.insert(bytes.end(), piece.data().begin(), piece.data().end());
      if (progress) progress(bytes.size(), size);
    }
    return reader->Finish();
  });
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  if (hash.finish() != sha256) throw ServiceError("", "the container was damaged on its way", false);
  return bytes;
}

}  // namespace lightwell::server
