// The standard services beside our own: health and reflection, called as any gRPC tool calls them.
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>

#include "tests/server/service_fixture.h"

namespace lightwell::test {
namespace {

class ServiceIntrospection : public ServiceTest {
 protected:
  /// One message there and one back, both as bytes on the wire: their .proto files are not ours.
  grpc::Status call(const std::string& method, const std::string& request, std::string& response) {
    grpc::GenericStub stub(grpc::CreateChannel(daemon_->address(), grpc::InsecureChannelCredentials()));
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(10));
    grpc::CompletionQueue queue;
    const auto next = [&] {
      void* tag;
      bool ok = false;
      return queue.Next(&tag, &ok) && ok;
    };
    const auto stream = stub.PrepareCall(&context, method, &queue);
    stream->StartCall(nullptr);
    next();
    const grpc::Slice slice(request);
    stream->Write(grpc::ByteBuffer(&slice, 1), nullptr);
    next();
    stream->WritesDone(nullptr);
    next();
    grpc::ByteBuffer buffer;
    stream->Read(&buffer, nullptr);
    if (next()) {
      std::vector<grpc::Slice> slices;
      if (!buffer.Dump(&slices).ok()) ADD_FAILURE();
      for (const auto& part : slices) response.append(reinterpret_cast<const char*>(part.begin()), part.size());
    }
    grpc::Status status;
    stream->Finish(&status, nullptr);
    next();
    return status;
  }
};

TEST_F(ServiceIntrospection, HealthSaysServing) {
  startDaemon();
  for (const std::string service : {"", "lightwell.v1.BakeService"}) {
    const std::string request = service.empty() ? "" : std::string("\x0a") + char(service.size()) + service;  // field 1: service
    std::string response;
    const grpc::Status status = call("/grpc.health.v1.Health/Check", request, response);
    EXPECT_TRUE(status.ok()) << status.error_message();
    EXPECT_EQ(response, "\x08\x01") << "status: SERVING";
  }
  std::string response;
  EXPECT_EQ(call("/grpc.health.v1.Health/Check", "\x0a\x03" "abc", response).error_code(), grpc::StatusCode::NOT_FOUND);
}

TEST_F(ServiceIntrospection, ReflectionListsTheServiceAndItsFile) {
  startDaemon();
  const std::string method = "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo";
  std::string response;
  EXPECT_TRUE(call(method, "\x3a\x01*", response).ok());  // field 7: list_services
  EXPECT_NE(response.find("lightwell.v1.BakeService"), std::string::npos);
  EXPECT_NE(response.find("grpc.health.v1.Health"), std::string::npos);
  const std::string symbol = "lightwell.v1.BakeService";
  response.clear();
  EXPECT_TRUE(call(method, std::string("\x22") + char(symbol.size()) + symbol, response).ok());  // field 4: file_containing_symbol
  EXPECT_NE(response.find("SubmitJobRequest"), std::string::npos) << "the descriptor of the file";
}

TEST_F(ServiceIntrospection, TokensGuardOurServiceAlone) {
  writeFile(path("tokens"), "anna " + std::string(20, 'a') + "\n");
  std::filesystem::permissions(path("tokens"), std::filesystem::perms::owner_read);
  startDaemon({"--token-file", path("tokens")});
  std::string response;
  EXPECT_TRUE(call("/grpc.health.v1.Health/Check", "", response).ok()) << "a load balancer has no token";
  EXPECT_EQ(call("/lightwell.v1.BakeService/GetServerInfo", "", response).error_code(), grpc::StatusCode::UNAUTHENTICATED);
}

}  // namespace
}  // namespace lightwell::test
