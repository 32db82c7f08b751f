// Requests that nobody should send: clear statuses, and the server stays.
#include <arpa/inet.h>
#include <grpcpp/grpcpp.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "lightwell/v1/service.grpc.pb.h"
#include "precompute/core/sanitizer.h"
#include "server/store/sha256.h"
#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

using grpc::StatusCode;

class ServiceAbuse : public ServiceTest {
 protected:
  void connect() {
    grpc::ChannelArguments arguments;
    arguments.SetMaxSendMessageSize(-1);
    channel_ = grpc::CreateCustomChannel(daemon_->address(), grpc::InsecureChannelCredentials(), arguments);
    stub_ = v1::BakeService::NewStub(channel_);
  }
  grpc::Status submit(const v1::JobSpec& spec) {
    grpc::ClientContext context;
    v1::SubmitJobRequest request;
    *request.mutable_spec() = spec;
    v1::Job job;
    const grpc::Status status = stub_->SubmitJob(&context, request, &job);
    const auto& trailers = context.GetServerTrailingMetadata();
    const auto found = trailers.find("lightwell-error-id");
    error_id_ = found == trailers.end() ? "" : std::string(found->second.data(), found->second.size());
    return status;
  }
  grpc::Status upload(const std::vector<v1::UploadRequest>& messages, v1::UploadState* state) {
    grpc::ClientContext context;
    const auto writer = stub_->Upload(&context, state);
    for (const auto& message : messages)
      if (!writer->Write(message)) break;
    writer->WritesDone();
    return writer->Finish();
  }
  static v1::UploadRequest piece(const std::string& sha256, uint64_t size, uint64_t offset, const std::string& data) {
    v1::UploadRequest message;
    message.set_sha256(sha256);
    message.set_size(size);
    message.set_offset(offset);
    message.set_data(data);
    return message;
  }
  void expectAlive() {
    grpc::ClientContext context;
    v1::ServerInfo info;
    EXPECT_TRUE(stub_->GetServerInfo(&context, {}, &info).ok());
  }
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::BakeService::Stub> stub_;
  std::string error_id_;
};

TEST_F(ServiceAbuse, MalformedSpecs) {
  startDaemon();
  connect();
  const auto files = server::filesOfScene(scene("room.gltf"));
  const CancelFlag never;
  server::Client(clientOptions(*daemon_), never).upload(files);
  const v1::JobSpec sound = quickSpec(files);
  const auto expect = [&](const char* id, StatusCode code, auto change) {
    v1::JobSpec spec = sound;
    change(spec);
    EXPECT_EQ(submit(spec).error_code(), code) << spec.ShortDebugString();
    EXPECT_EQ(error_id_, id) << spec.ShortDebugString();
  };
  using Spec = v1::JobSpec;
  for (const std::string name : {"../room.gltf", "/etc/passwd", "a/../../b", "./room.gltf", "", ".", "a//b", "a\nb"})
    expect("invalid_request", StatusCode::INVALID_ARGUMENT, [&](Spec& s) { s.mutable_files(0)->set_name(name), s.set_scene(name); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.clear_files(); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.set_scene("other.gltf"); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { *s.add_files() = s.files(0); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.mutable_files(0)->set_sha256("../../../../etc/passwd"); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.mutable_files(0)->set_size(7); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.set_priority(11); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.set_time_limit_s(-1); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.set_target_error(std::nan("")); });
  expect("invalid_request", StatusCode::INVALID_ARGUMENT, [](Spec& s) { s.set_label(std::string(201, 'x')); });
  for (const char* settings : {"{", "[]", R"({"quality": "best"})", R"({"no_such_key": 1})", R"({"lightmap_size": 100000})"})
    expect("invalid_settings", StatusCode::INVALID_ARGUMENT, [&](Spec& s) { s.set_settings_json(settings); });
  expect("missing_file", StatusCode::FAILED_PRECONDITION, [](Spec& s) { s.mutable_files(0)->set_sha256(std::string(64, '0')); });
  EXPECT_TRUE(submit(sound).ok());
}

TEST_F(ServiceAbuse, UnknownJobs) {
  startDaemon();
  connect();
  v1::GetJobRequest request;
  for (const std::string id : {"", "0123456789abcdef", "'; DROP TABLE jobs; --", "../../etc/passwd"}) {
    request.set_id(id);
    grpc::ClientContext context;
    v1::Job job;
    EXPECT_EQ(stub_->GetJob(&context, request, &job).error_code(), StatusCode::NOT_FOUND) << id;
  }
  grpc::ClientContext context;
  v1::ListJobsRequest list;
  list.set_page_token("none of yours");
  v1::ListJobsResponse page;
  EXPECT_EQ(stub_->ListJobs(&context, list, &page).error_code(), StatusCode::INVALID_ARGUMENT);
}

TEST_F(ServiceAbuse, Uploads) {
  startDaemon({"--max-upload-bytes", "3MB", "--max-client-bytes", "4MB"});
  connect();
  v1::UploadState state;
  const std::string data(1000, 'x'), sha = server::sha256(data);
  EXPECT_EQ(upload({}, &state).error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(upload({piece("../../../etc/passwd", 4, 0, "root")}, &state).error_code(), StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(upload({piece(sha, 4000000, 0, data)}, &state).error_code(), StatusCode::RESOURCE_EXHAUSTED) << "announced too large";
  EXPECT_EQ(upload({piece(sha, 500, 0, data)}, &state).error_code(), StatusCode::RESOURCE_EXHAUSTED) << "more than announced";
  EXPECT_EQ(upload({piece(std::string(64, '0'), 1000, 0, data)}, &state).error_code(), StatusCode::INVALID_ARGUMENT) << "not its hash";
  EXPECT_EQ(upload({piece(sha, 1000, 999, "x")}, &state).error_code(), StatusCode::OUT_OF_RANGE) << "leaves out what is not there";
  EXPECT_EQ(upload({piece(sha, 3000000, 0, std::string((1 << 20) + 1, 'x'))}, &state).error_code(), StatusCode::INVALID_ARGUMENT)
      << "a message too long for one piece";
  EXPECT_EQ(upload({piece(sha, 3000000, 0, std::string(8 << 20, 'x'))}, &state).error_code(), StatusCode::RESOURCE_EXHAUSTED)
      << "a message too long for anything";
  // Cut short: what came is kept, and the rest completes it.
  ASSERT_TRUE(upload({piece(sha, 1000, 0, data.substr(0, 600))}, &state).ok());
  EXPECT_FALSE(state.complete());
  EXPECT_EQ(state.received_bytes(), 600u);
  ASSERT_TRUE(upload({piece(sha, 1000, 600, data.substr(600))}, &state).ok());
  EXPECT_TRUE(state.complete());
  // Four megabytes of one client, and no more.
  const std::string large(2900000, 'y'), more(1500000, 'z');
  const auto pieces = [&](const std::string& bytes) {
    std::vector<v1::UploadRequest> all;
    for (size_t at = 0; at < bytes.size(); at += 1 << 20) all.push_back(piece(server::sha256(bytes), bytes.size(), 0, bytes.substr(at, 1 << 20)));
    return all;
  };
  EXPECT_TRUE(upload(pieces(large), &state).ok());
  EXPECT_EQ(upload(pieces(more), &state).error_code(), StatusCode::RESOURCE_EXHAUSTED);
  expectAlive();
}

TEST_F(ServiceAbuse, StalledUploadsAreEndedAndGoOnLater) {
  startDaemon({"--upload-idle-seconds", "1"});
  connect();
  const std::string data(1000, 'x');
  grpc::ClientContext context;
  v1::UploadState state;
  const auto writer = stub_->Upload(&context, &state);
  ASSERT_TRUE(writer->Write(piece(server::sha256(data), 1000, 0, data.substr(0, 10))));
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(writer->Finish().error_code(), StatusCode::DEADLINE_EXCEEDED);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(6));
  v1::FindUploadsRequest query;
  query.add_sha256(server::sha256(data));
  v1::FindUploadsResponse found;
  grpc::ClientContext again;
  ASSERT_TRUE(stub_->FindUploads(&again, query, &found).ok());
  EXPECT_EQ(found.uploads(0).received_bytes(), 10u);
}

/// Connections that say nothing, half a request or rubbish, on both ports, while others work.
TEST_F(ServiceAbuse, SlowAndSenselessConnections) {
  startDaemon();
  connect();
  std::vector<int> sockets;
  for (const int port : {std::stoi(daemon_->address().substr(daemon_->address().find(':') + 1)), daemon_->httpPort()})
    for (int i = 0; i < 12; ++i) {
      const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      sockaddr_in address{};
      address.sin_family = AF_INET;
      address.sin_port = htons(uint16_t(port));
      address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      ASSERT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
      const std::string text = i % 3 == 0 ? "" : i % 3 == 1 ? "GET /jobs.json HTT" : std::string(3000, '\xff');
      [[maybe_unused]] const ssize_t sent = send(fd, text.data(), text.size(), MSG_NOSIGNAL);
      sockets.push_back(fd);
    }
  expectAlive();
  httplib::Client http("127.0.0.1", daemon_->httpPort());
  http.set_read_timeout(10);
  const auto answer = http.Get("/healthz");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 200);
  for (const int fd : sockets) close(fd);
}

/// LIGHTWELL_SERVICE_WATCHES=10000 for the long form.
TEST_F(ServiceAbuse, IdleWatches) {
  const int count = scaled("LIGHTWELL_SERVICE_WATCHES", 500);
  startDaemon({"--workers", "1"}, true);
  connect();
  const auto files = server::filesOfScene(scene("hang.gltf"));
  const CancelFlag never;
  server::Client client(clientOptions(*daemon_), never);
  client.upload(files);
  client.submit(quickSpec(files, 1));
  const std::string queued = client.submit(quickSpec(files, 2)).id();
  const uint64_t before = daemon_->residentBytes();

  struct Watch {
    grpc::ClientContext context;
    v1::Job job;
    grpc::Status status;
    std::unique_ptr<grpc::ClientAsyncReader<v1::Job>> reader;
  };
  grpc::CompletionQueue queue;
  std::vector<std::unique_ptr<Watch>> watches;
  v1::WatchJobRequest request;
  request.set_id(queued);
  int heard = 0;
  void* tag = nullptr;
  bool ok = false;
  const auto next = [&] {
    return queue.AsyncNext(&tag, &ok, std::chrono::system_clock::now() + std::chrono::seconds(60)) == grpc::CompletionQueue::GOT_EVENT;
  };
  // Each: the call begins, then one state is read. Two events each.
  for (int i = 0; i < count; ++i) {
    watches.push_back(std::make_unique<Watch>());
    Watch& watch = *watches.back();
    watch.reader = stub_->AsyncWatchJob(&watch.context, request, &queue, &watch);
    ASSERT_TRUE(next() && ok);
    static_cast<Watch*>(tag)->reader->Read(&static_cast<Watch*>(tag)->job, tag);
    ASSERT_TRUE(next() && ok);
    ++heard;
  }
  EXPECT_EQ(heard, count);
  const double each = double(daemon_->residentBytes() - std::min(before, daemon_->residentBytes())) / count;
  std::printf("%d idle watches, %.1f kB of the daemon's memory each\n", count, each / 1000);
  EXPECT_LT(each, kSanitized ? 400e3 : 100e3);
  expectAlive();
  // All of them hear of the end.
  for (auto& watch : watches) watch->reader->Read(&watch->job, watch.get());
  client.cancel(queued);
  int ended = 0;
  while (ended < count && next()) ended += ok && static_cast<Watch*>(tag)->job.state() == v1::JOB_STATE_CANCELLED;
  EXPECT_EQ(ended, count);
  for (auto& watch : watches) watch->reader->Finish(&watch->status, watch.get());
  for (int i = 0; i < count; ++i) ASSERT_TRUE(next());
  for (auto& watch : watches) EXPECT_TRUE(watch->status.ok());
}

}  // namespace
}  // namespace lightwell::test
