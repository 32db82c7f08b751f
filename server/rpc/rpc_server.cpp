#include "server/rpc/rpc_server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>

#include <chrono>
#include <fstream>
#include <sstream>

#include "server/rpc/bake_service.h"
#include "server/rpc/requests.h"

namespace lightwell::server {
namespace {

std::string readFile(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw UsageError("cannot read " + file.string());
  return text.str();
}

std::shared_ptr<grpc::ServerCredentials> credentialsOf(const Options& options) {
  if (!options.tls_certificate) return grpc::InsecureServerCredentials();
  grpc::SslServerCredentialsOptions tls(options.tls_client_ca ? GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY
                                                              : GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  tls.pem_key_cert_pairs.push_back({readFile(*options.tls_key), readFile(*options.tls_certificate)});
  if (options.tls_client_ca) tls.pem_root_certs = readFile(*options.tls_client_ca);
  return grpc::SslServerCredentials(tls);
}

}  // namespace

RpcServer::RpcServer(const Options& options, BakeService& service) {
  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  int port = 0;
  builder.AddListeningPort(options.listen, credentialsOf(options), &port);
  builder.RegisterService(&service);
  builder.SetMaxReceiveMessageSize(int(kMaxMessageBytes));
  // Two daemons never share a port; who connects and then says nothing is let go.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, 10000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 30000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 20000);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 5000);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
  builder.AddChannelArgument(GRPC_ARG_MAX_METADATA_SIZE, 16 << 10);
  server_ = builder.BuildAndStart();
  if (!server_ || port == 0)
    throw UsageError("cannot listen on " + options.listen + ": the port is taken, the address is not this machine's, or TLS files do not fit");
  // The default service answers for the whole server alone.
  server_->GetHealthCheckService()->SetServingStatus(v1::BakeService::service_full_name(), true);
}

RpcServer::~RpcServer() { shutDown(); }

void RpcServer::shutDown() {
  if (!server_) return;
  if (auto* health = server_->GetHealthCheckService()) health->SetServingStatus(false);
  server_->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(2));
  server_->Wait();
  server_.reset();
}

}  // namespace lightwell::server
