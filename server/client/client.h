// The service from a client's side. Calls are repeated while the server cannot be reached: all of them are safe to repeat.
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "lightwell/v1/service.pb.h"
#include "precompute/core/diagnostics.h"
#include "server/client/scene_files.h"

namespace lightwell::server {

struct ClientOptions {
  std::string server = "127.0.0.1:7411";
  std::optional<std::filesystem::path> token_file;       // the last word of its first line is the token
  std::optional<std::filesystem::path> tls_ca;           // PEM; TLS with servers of this authority
  std::optional<std::filesystem::path> tls_certificate, tls_key;  // of the client itself
  double patience_s = 5;                                 // how long an unreachable server is called: it may be starting
  double watch_patience_s = 60;                          // likewise, for one that was reached before: it may be restarting
  std::function<void(const std::string& what)> waiting;  // told, once, what is waited for; may be empty
};

/// The server refused, failed or could not be reached.
class ServiceError : public std::runtime_error {
 public:
  ServiceError(std::string id, const std::string& message, bool unreachable)
      : std::runtime_error(message), id(std::move(id)), unreachable(unreachable) {}
  std::string id;  // stable; empty when the server gave none
  bool unreachable;
};

/// One connection, for one thread. Every call throws ServiceError, and Cancelled soon after `cancel` is set.
class Client {
 public:
  /// Throws UsageError for files that cannot be read, and for a token without TLS to a server that is not on this machine.
  Client(const ClientOptions& options, const CancelFlag& cancel);
  ~Client();

  v1::ServerInfo info();
  /// Sends what the server does not have yet. `progress` gets bytes sent and the sum of all.
  void upload(const std::vector<LocalFile>& files, const std::function<void(uint64_t, uint64_t)>& progress = {});
  /// Makes one job, however often it is repeated: an idempotency key is added.
  v1::Job submit(const v1::JobSpec& spec);
  v1::Job get(const std::string& id);
  v1::ListJobsResponse list(const v1::ListJobsRequest& request);
  /// Until the job is final; also across restarts of the server.
  v1::Job watch(const std::string& id, const std::function<void(const v1::Job&)>& changed);
  v1::Job cancel(const std::string& id);
  void remove(const std::string& id);
  /// The container, its SHA-256 checked.
  std::vector<uint8_t> download(const std::string& id, const std::function<void(uint64_t, uint64_t)>& progress = {});

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace lightwell::server
