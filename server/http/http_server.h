// The HTTP port: status page, jobs as JSON, pictures and containers to download, /metrics and /healthz. Reads only.
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "server/tokens.h"
#include "server/store/blob_store.h"
#include "server/execution/jobs.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace lightwell::server {

struct HttpOptions {
  std::string address;                                            // HOST:PORT
  std::optional<std::filesystem::path> tls_certificate, tls_key, tls_client_ca;
};

class HttpServer {
 public:
  /// Listens when it returns. Throws UsageError when the port is taken.
  HttpServer(const HttpOptions& options, Jobs& jobs, BlobStore& blobs, const Tokens& tokens, std::function<std::string()> metrics);
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

 private:
  void addRoutes();
  std::string client(const httplib::Request& request) const;
  Jobs& jobs_;
  BlobStore& blobs_;
  const Tokens& tokens_;
  const std::function<std::string()> metrics_;
  std::unique_ptr<httplib::Server> server_;
  std::thread thread_;
};

}  // namespace lightwell::server
