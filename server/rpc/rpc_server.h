// The gRPC port: transport security, limits of connections, health and reflection.
#pragma once
#include <memory>

#include "server/options.h"

namespace grpc {
class Server;
class Service;
}  // namespace grpc

namespace lightwell::server {

class BakeService;

class RpcServer {
 public:
  /// Listens when it returns. Throws UsageError when it cannot.
  RpcServer(const Options& options, BakeService& service);
  ~RpcServer();
  /// Takes no more calls; ends what is open after two seconds.
  void shutDown();

 private:
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace lightwell::server
