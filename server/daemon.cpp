#include "server/daemon.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <system_error>
#include <thread>

#include "server/http/http_server.h"
#include "server/http/metrics.h"
#include "server/rpc/bake_service.h"
#include "server/rpc/requests.h"
#include "server/rpc/rpc_server.h"
#include "server/job/job_state.h"
#include "server/execution/scheduler.h"

namespace lightwell::server {
namespace fs = std::filesystem;
namespace {

constexpr double kPartialKeep_s = 86400;
constexpr int kSweepEvery_s = 60;

/// The data folder, held against other daemons for as long as this lives.
class DataFolder {
 public:
  explicit DataFolder(const fs::path& folder) : path(folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (!error) fs::permissions(folder, fs::perms::group_all | fs::perms::others_all, fs::perm_options::remove, error);
    if (error) throw UsageError("cannot use the folder " + folder.string() + ": " + error.message());
    lock_ = open((folder / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (lock_ < 0) throw UsageError("cannot use the folder " + folder.string() + ": " + std::strerror(errno));
    // The last daemon may be about to end.
    for (int attempt = 0; flock(lock_, LOCK_EX | LOCK_NB) != 0; ++attempt) {
      if (attempt == 20) throw UsageError("the folder " + folder.string() + " is in use by another lightwelld");
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    fs::remove_all(folder / "tasks" / "tmp", error);  // half-written results of workers that were killed
  }
  ~DataFolder() { close(lock_); }
  const fs::path path;

 private:
  int lock_ = -1;
};

v1::ServerInfo infoOf(const Options& options) {
  v1::ServerInfo info;
  info.set_version(LIGHTWELL_VERSION);
  info.set_workers(options.workers);
  info.set_threads_per_worker(options.threads_per_worker);
  info.set_max_message_bytes(kMaxMessageBytes);
  info.set_max_upload_bytes(options.max_upload_bytes);
  info.set_max_files_per_job(kMostFilesPerJob);
  info.set_max_job_memory_bytes(options.max_job_memory_bytes);
  info.set_max_job_wall_s(options.max_job_wall_s);
  info.set_max_unfinished_jobs(options.max_client_jobs);
  info.set_max_client_bytes(options.max_client_bytes);
  info.set_max_store_bytes(options.max_store_bytes);
  info.set_upload_keep_s(options.upload_keep_s);
  return info;
}

SchedulerOptions schedulerOptions(const Options& options) {
  return {.worker_program = options.worker_program, .task_folder = options.data / "tasks", .blob_folder = options.data / "blobs",
          .workers = options.workers, .threads_per_worker = options.threads_per_worker,
          .max_job_memory_bytes = options.max_job_memory_bytes, .max_job_wall_s = options.max_job_wall_s,
          .min_free_disk_bytes = options.min_free_disk_bytes};
}

}  // namespace

/// Members in the order of their dependence; the ports open last and close first.
struct Daemon::Parts {
  Parts(const Options& options, const Log& log)
      : log(log), folder(options.data), tokens(options.token_file ? Tokens(*options.token_file) : Tokens()), metrics(LIGHTWELL_VERSION),
        store(options.data / "jobs.sqlite"), recovered(store.recover()), blobs(options.data / "blobs"),
        retention(options.data / "tasks", options.data / "uploads", blobs, store,
                  {.max_store_bytes = options.max_store_bytes, .upload_keep_s = options.upload_keep_s,
                   .finished_keep_s = options.finished_keep_s, .partial_keep_s = kPartialKeep_s}),
        uploads(options.data / "uploads", blobs, store,
                {.max_file_bytes = options.max_upload_bytes, .max_client_bytes = options.max_client_bytes},
                [this](uint64_t bytes) { return retention.makeRoom(bytes); }),
        jobs(store),
        service({.jobs = jobs, .uploads = uploads, .blobs = blobs, .retention = retention, .tokens = tokens, .info = infoOf(options),
                 .limits = {.max_unfinished_jobs = options.max_client_jobs, .max_watches = options.max_watches,
                            .max_uploads = options.max_uploads, .upload_idle_s = options.upload_idle_s},
                 .submitted = [this](double seconds) { metrics.submitted(seconds); }}),
        rpc(options, service) {
    if (!options.http.empty())
      http = std::make_unique<HttpServer>(
          HttpOptions{options.http, options.tls_certificate, options.tls_key, options.tls_client_ca}, jobs, blobs, tokens,
          [this] { return metricsText(); });
    // Only now, when nothing can fail any more.
    scheduler = std::make_unique<Scheduler>(schedulerOptions(options), jobs, store, blobs, events());
    ticker = std::thread([this] { tick(); });
  }

  ~Parts() {
    {
      std::lock_guard lock(mutex);
      ending = true;
    }
    ended.notify_all();
    ticker.join();
    service.shutDown();
    scheduler.reset();
    rpc.shutDown();
    http.reset();
  }

  SchedulerEvents events() {
    return {.started = [this](const v1::Job& job) {
              log(LogLevel::info, "job started", {{"job", job.id()}, {"client", job.client()}, {"scene", job.spec().scene()}});
            },
            .ended = [this](const std::string& id, const Ending& ending, double seconds) {
              metrics.ended(ending, seconds);
              const bool failed = ending.state == v1::JOB_STATE_FAILED;
              log(failed ? LogLevel::warning : LogLevel::info, "job ended",
                  {{"job", id}, {"state", name(ending.state)}, {"seconds", std::to_string(seconds)}, {"error", ending.error.id()},
                   {"reason", ending.error.message()}});
            },
            .trouble = [this](const std::string& what) { log(LogLevel::error, "trouble", {{"reason", what}}); }};
  }

  std::string metricsText() {
    std::error_code error;
    const auto space = fs::space(folder.path, error);
    return metrics.text({.jobs = jobs.counts(), .watches = service.watches(), .uploads = service.uploads(),
                         .store_bytes = retention.storeBytes(), .free_disk_bytes = error ? 0 : space.available});
  }

  void tick() {
    std::unique_lock lock(mutex);
    for (int second = 1; !ended.wait_for(lock, std::chrono::seconds(1), [this] { return ending; }); ++second) {
      lock.unlock();
      try {
        service.tick();
        if (second % kSweepEvery_s == 0) {
          retention.sweep();
          uploads.removeStale(kPartialKeep_s);
        }
      } catch (const std::exception& trouble) {
        log(LogLevel::error, "trouble", {{"reason", trouble.what()}});
      }
      lock.lock();
    }
  }

  const Log& log;
  DataFolder folder;
  const Tokens tokens;
  Metrics metrics;
  JobStore store;
  const size_t recovered;
  BlobStore blobs;
  Retention retention;
  Uploads uploads;
  Jobs jobs;
  BakeService service;
  RpcServer rpc;
  std::unique_ptr<HttpServer> http;
  std::unique_ptr<Scheduler> scheduler;
  std::mutex mutex;
  std::condition_variable ended;
  bool ending = false;
  std::thread ticker;
};

Daemon::Daemon(const Options& options, const Log& log) : parts_(std::make_unique<Parts>(options, log)) {
  log(LogLevel::info, "serving",
      {{"version", LIGHTWELL_VERSION}, {"listen", options.listen}, {"http", options.http}, {"data", options.data.string()},
       {"workers", std::to_string(options.workers)}, {"resumed_jobs", std::to_string(parts_->recovered)}});
}
Daemon::~Daemon() = default;

}  // namespace lightwell::server
