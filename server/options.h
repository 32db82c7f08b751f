// lightwelld's options: command line, then a config file, then defaults.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "precompute/core/error.h"

namespace lightwell::server {

struct Options {
  std::filesystem::path data;
  std::string listen = "127.0.0.1:7411";
  std::string http = "127.0.0.1:7412";  // empty: none
  uint32_t workers = 1;
  uint32_t threads_per_worker = 0;      // 0: the machine's processors divided among the workers

  std::optional<std::filesystem::path> token_file, tls_certificate, tls_key, tls_client_ca;

  double max_job_wall_s = 0;            // 0: none
  uint64_t max_job_memory_bytes = 0;    // 0: three quarters of the machine's memory divided among the workers
  uint64_t max_upload_bytes = 4ull << 30;
  uint64_t max_client_bytes = 64ull << 30;
  uint32_t max_client_jobs = 10000;     // unfinished
  uint32_t max_watches = 20000;
  uint32_t max_uploads = 256;
  double upload_idle_s = 30;
  uint64_t max_store_bytes = 100ull << 30;
  uint64_t min_free_disk_bytes = 256ull << 20;
  double upload_keep_s = 3600;
  double finished_keep_s = 30 * 86400.0;

  std::string log_level = "info";
  bool log_json = false;
  std::filesystem::path worker_program; // empty: lightwell_worker beside this program
};

/// Parses and completes. Prints help or version and returns nothing when that was asked for. Throws UsageError; also for places that are not
/// of this machine alone without a token file and TLS.
std::optional<Options> parseOptions(int argc, char** argv, const std::string& version);

/// Whether "HOST:PORT" is of this machine alone. Throws UsageError for what is no such pair.
bool isLoopback(const std::string& address);

}  // namespace lightwell::server
