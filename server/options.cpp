#include "server/options.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <thread>

namespace lightwell::server {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFooter = R"(Examples:
  lightwelld --data /var/lib/lightwell
  lightwelld --config /etc/lightwell/lightwelld.toml
  lightwelld --data DIR --listen 0.0.0.0:7411 --token-file tokens --tls-certificate server.crt --tls-key server.key

A config file holds the long options' names without dashes: listen = "127.0.0.1:7411". The command line goes before it.
Exit codes: 0 ended by a signal, 1 an error of this program, 2 wrong usage, a folder that cannot be used or a port that is taken.)";

struct HostPort {
  std::string host;
  int port = 0;
};

HostPort split(const std::string& address) {
  const size_t colon = address.rfind(':');
  const auto refuse = [&] { throw UsageError("\"" + address + "\" is not HOST:PORT"); };
  if (colon == std::string::npos || colon == 0 || colon + 1 == address.size() || address.size() - colon > 6) refuse();
  HostPort result{address.substr(0, colon), 0};
  for (size_t i = colon + 1; i < address.size(); ++i) {
    if (address[i] < '0' || address[i] > '9') refuse();
    result.port = result.port * 10 + (address[i] - '0');
  }
  if (result.port > 65535) refuse();
  return result;
}

void complete(Options& options) {
  const uint32_t processors = std::max(1u, std::thread::hardware_concurrency());
  if (options.threads_per_worker == 0) options.threads_per_worker = std::max(1u, processors / options.workers);
  const uint64_t memory = uint64_t(sysconf(_SC_PHYS_PAGES)) * uint64_t(sysconf(_SC_PAGESIZE));
  if (options.max_job_memory_bytes == 0) options.max_job_memory_bytes = memory / 4 * 3 / options.workers;
  if (options.worker_program.empty()) options.worker_program = fs::read_symlink("/proc/self/exe").parent_path() / "lightwell_worker";
  if (access(options.worker_program.c_str(), X_OK) != 0)
    throw UsageError("there is no program " + options.worker_program.string() + ", which bakes the jobs");
}

void checkSecurity(const Options& options) {
  if (options.tls_certificate.has_value() != options.tls_key.has_value())
    throw UsageError("--tls-certificate and --tls-key need each other");
  if (options.tls_client_ca && !options.tls_certificate) throw UsageError("--tls-client-ca needs --tls-certificate and --tls-key");
  for (const std::string& address : {options.listen, options.http}) {
    if (address.empty() || isLoopback(address)) continue;
    if (!options.token_file || !options.tls_certificate)
      throw UsageError("will not listen on " + address + ", which others can reach, without --token-file, --tls-certificate and --tls-key");
  }
}

}  // namespace

bool isLoopback(const std::string& address) {
  const std::string host = split(address).host;
  return host == "localhost" || host == "[::1]" || host.starts_with("127.");
}

std::optional<Options> parseOptions(int argc, char** argv, const std::string& version) {
  Options options;
  CLI::App app("The bake service: keeps every accepted job, bakes it in a process of its own, serves the container.", "lightwelld");
  app.set_version_flag("--version", "lightwelld " + version);
  app.footer(kFooter);
  app.get_formatter()->column_width(38);
  app.set_config("--config", "", "TOML file with these options")->type_name("FILE");
  app.allow_config_extras(false);
  const auto bytes = CLI::AsSizeValue(false);
  app.add_option("--data", options.data, "Folder of jobs, scenes, containers and task results; created if needed")->required()->type_name("DIR");
  app.add_option("--listen", options.listen, "Where to serve gRPC")->type_name("HOST:PORT")->capture_default_str();
  app.add_option("--http", options.http, "Where to serve the status page, /metrics and /healthz; \"\" for none")
      ->type_name("HOST:PORT")->capture_default_str();
  app.add_option("--workers", options.workers, "Jobs that run at once")->type_name("N")->check(CLI::Range(1, 256))->capture_default_str();
  app.add_option("--threads-per-worker", options.threads_per_worker, "0: the processors divided among the workers")
      ->type_name("N")->check(CLI::Range(0, 1024))->capture_default_str();

  app.add_option("--token-file", options.token_file, "Who may call: lines of NAME TOKEN")->type_name("FILE")->group("Security");
  app.add_option("--tls-certificate", options.tls_certificate, "PEM, with its chain")->type_name("FILE")->group("Security");
  app.add_option("--tls-key", options.tls_key, "PEM")->type_name("FILE")->group("Security");
  app.add_option("--tls-client-ca", options.tls_client_ca, "PEM: only clients with a certificate of this authority may connect")
      ->type_name("FILE")->group("Security");

  const std::string limits = "Limits (bytes may have a unit: 8GB)";
  const auto limit = [&](const char* option, auto& value, const char* what) {
    return app.add_option(option, value, what)->group(limits)->capture_default_str();
  };
  limit("--max-job-seconds", options.max_job_wall_s, "A job's running time; 0: none")->type_name("S")->check(CLI::NonNegativeNumber);
  limit("--max-job-memory", options.max_job_memory_bytes, "A worker's memory; 0: three quarters of the machine's, divided among the workers")
      ->type_name("BYTES")->transform(bytes);
  limit("--max-upload-bytes", options.max_upload_bytes, "One file")->type_name("BYTES")->transform(bytes);
  limit("--max-client-bytes", options.max_client_bytes, "One client's uploads in the store")->type_name("BYTES")->transform(bytes);
  limit("--max-client-jobs", options.max_client_jobs, "One client's unfinished jobs")->type_name("N");
  limit("--max-watches", options.max_watches, "Open watches of all clients")->type_name("N");
  limit("--max-uploads", options.max_uploads, "Uploads at once")->type_name("N");
  limit("--upload-idle-seconds", options.upload_idle_s, "An upload that sends nothing for so long is ended")->type_name("S")
      ->check(CLI::PositiveNumber);
  limit("--max-store-bytes", options.max_store_bytes, "The data folder; what is unused longest goes first")->type_name("BYTES")->transform(bytes);
  limit("--min-free-disk", options.min_free_disk_bytes, "No job starts with less room on the disk")->type_name("BYTES")->transform(bytes);
  limit("--keep-uploads-seconds", options.upload_keep_s, "Uploads stay at least so long after their last use")->type_name("S")
      ->check(CLI::NonNegativeNumber);
  limit("--keep-finished-seconds", options.finished_keep_s, "Finished jobs are deleted after so long")->type_name("S")
      ->check(CLI::NonNegativeNumber);

  app.add_option("--log-level", options.log_level)->type_name("NAME")
      ->check(CLI::IsMember({"debug", "info", "warning", "error"}))->capture_default_str();
  app.add_flag("--log-json", options.log_json, "One JSON object a line, on stderr");
  app.add_option("--worker-program", options.worker_program, "What bakes a job; default: lightwell_worker beside this program")->type_name("FILE");
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& success) {
    app.exit(success);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw UsageError(error.what() + std::string("\nTry lightwelld --help."));
  }
  checkSecurity(options);
  complete(options);
  return options;
}

}  // namespace lightwell::server
