#include "server/http/http_server.h"

#include <httplib.h>

#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>

#include "precompute/core/error.h"
#include "server/failure.h"
#include "server/job/job_json.h"
#include "server/http/page.h"
#include "server/job/job_state.h"

namespace lightwell::server {
namespace {

constexpr int kThreads = 16;
constexpr uint32_t kJobsOnPage = 100;

/// Without tokens only this machine may ask; a page of somebody else's that a browser here has open must not, under whatever name it reaches
/// us (DNS rebinding).
bool isLocalName(std::string host) {
  if (const size_t bracket = host.find(']'); bracket != std::string::npos) host.resize(bracket + 1);
  else host = host.substr(0, host.find(':'));
  return host == "localhost" || host == "[::1]" || host.starts_with("127.");
}

void respondJson(httplib::Response& response, const nlohmann::json& document) {
  response.set_content(document.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace), "application/json");
}

int httpStatus(FailureId id) {
  switch (id) {
    case FailureId::unauthenticated: return 401;
    case FailureId::job_not_found: return 404;
    case FailureId::job_unfinished:
    case FailureId::no_result: return 409;
    case FailureId::invalid_request: return 400;
    default: return 500;
  }
}

/// Sends a blob without holding it in memory.
void respondBlob(httplib::Response& response, const std::filesystem::path& path, uint64_t size, const char* type) {
  const auto file = std::make_shared<std::ifstream>(path, std::ios::binary);
  if (!*file) throw Failure(FailureId::internal, "the file is missing in the store");
  response.set_content_provider(size, type, [file](size_t offset, size_t length, httplib::DataSink& sink) {
    char buffer[1 << 16];
    file->seekg(std::streamoff(offset));
    file->read(buffer, std::streamsize(std::min(length, sizeof buffer)));
    return file->gcount() > 0 && sink.write(buffer, size_t(file->gcount()));
  });
}

}  // namespace

HttpServer::HttpServer(const HttpOptions& options, Jobs& jobs, BlobStore& blobs, const Tokens& tokens, std::function<std::string()> metrics)
    : jobs_(jobs), blobs_(blobs), tokens_(tokens), metrics_(std::move(metrics)) {
  if (options.tls_certificate)
    server_ = std::make_unique<httplib::SSLServer>(options.tls_certificate->c_str(), options.tls_key->c_str(),
                                                   options.tls_client_ca ? options.tls_client_ca->c_str() : nullptr);
  else
    server_ = std::make_unique<httplib::Server>();
  if (!server_->is_valid()) throw UsageError("the TLS certificate or key cannot be used");
  server_->new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server_->set_read_timeout(3, 0);
  server_->set_write_timeout(10, 0);
  server_->set_keep_alive_timeout(2);
  server_->set_payload_max_length(4096);
  addRoutes();
  const size_t colon = options.address.rfind(':');
  std::string host = options.address.substr(0, colon);
  if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
  if (!server_->bind_to_port(host.c_str(), std::stoi(options.address.substr(colon + 1))))
    throw UsageError("cannot listen on " + options.address + ": the port is taken, or the address is not this machine's");
  thread_ = std::thread([this] { server_->listen_after_bind(); });
  while (!server_->is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

HttpServer::~HttpServer() {
  server_->stop();
  thread_.join();
}

std::string HttpServer::client(const httplib::Request& request) const {
  if (!tokens_.required()) {
    if (isLocalName(request.get_header_value("Host"))) return "";  // all clients' jobs: there is only one
    throw Failure(FailureId::unauthenticated, "ask under the name localhost, or start the server with tokens");
  }
  if (const auto name = tokens_.authorize(request.get_header_value("Authorization"))) return *name;
  throw Failure(FailureId::unauthenticated, "a token is needed: as Bearer, or as the password of Basic");
}

void HttpServer::addRoutes() {
  // Every handler of jobs goes through here: who asks, and what its failures look like.
  const auto route = [this](const std::string& pattern, auto handler) {
    server_->Get(pattern, [this, handler](const httplib::Request& request, httplib::Response& response) {
      response.set_header("Cache-Control", "no-store");
      response.set_header("X-Content-Type-Options", "nosniff");
      response.set_header("Content-Security-Policy",
                          "default-src 'none'; img-src 'self'; connect-src 'self'; style-src 'unsafe-inline'; script-src 'unsafe-inline'");
      try {
        handler(request, response, client(request));
      } catch (const Failure& failure) {
        response.status = httpStatus(failure.id);
        if (failure.id == FailureId::unauthenticated && tokens_.required())
          response.set_header("WWW-Authenticate", "Basic realm=\"lightwelld\", charset=\"UTF-8\"");
        respondJson(response, {{"error", {{"id", name(failure.id)}, {"message", failure.what()}}}});
      } catch (const std::exception& error) {
        response.status = 500;
        respondJson(response, {{"error", {{"id", "internal"}, {"message", error.what()}}}});
      }
    });
  };
  server_->Get("/healthz", [](const httplib::Request&, httplib::Response& response) { response.set_content("ok\n", "text/plain"); });
  route("/metrics", [this](const httplib::Request&, httplib::Response& response, const std::string&) {
    response.set_content(metrics_(), "text/plain; version=0.0.4");
  });
  route("/", [](const httplib::Request&, httplib::Response& response, const std::string&) {
    response.set_content(kPage, sizeof kPage - 1, "text/html; charset=utf-8");
  });
  route("/jobs.json", [this](const httplib::Request&, httplib::Response& response, const std::string& client) {
    nlohmann::json document{{"jobs", nlohmann::json::array()}, {"counts", nlohmann::json::object()}};
    for (const auto& job : jobs_.list(client, {}, "", 0, kJobsOnPage).jobs) document["jobs"].push_back(jobJson(*job));
    if (client.empty())  // how many there are of everybody's is nobody else's business
      for (const auto& [state, count] : jobs_.counts()) document["counts"][name(state)] = count;
    respondJson(response, document);
  });
  route(R"(/jobs/([0-9a-f]{16})\.json)", [this](const httplib::Request& request, httplib::Response& response, const std::string& client) {
    respondJson(response, jobJson(*jobs_.get(request.matches[1], client)));
  });
  route(R"(/jobs/([0-9a-f]{16})/(result\.lwc|preview\.png))",
        [this](const httplib::Request& request, httplib::Response& response, const std::string& client) {
          const JobPtr job = jobs_.get(request.matches[1], client);
          if (job->state() != v1::JOB_STATE_SUCCEEDED) throw Failure(FailureId::no_result, "the job has no container");
          const bool picture = request.matches[2] == "preview.png";
          const std::string blob = picture ? job->result().preview_sha256() : job->result().sha256();
          if (blob.empty()) throw Failure(FailureId::no_result, "the container has nothing to show");
          const auto size = blobs_.size(blob);
          if (!size) throw Failure(FailureId::internal, "the file is missing in the store");
          if (!picture) response.set_header("Content-Disposition", "attachment; filename=\"" + job->id() + ".lwc\"");
          respondBlob(response, blobs_.fileOf(blob), *size, picture ? "image/png" : "application/octet-stream");
        });
}

}  // namespace lightwell::server
