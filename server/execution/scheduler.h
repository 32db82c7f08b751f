// Which job runs when: N slots, each a thread that runs one worker process after the other.
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "server/store/blob_store.h"
#include "server/execution/jobs.h"
#include "server/execution/worker_process.h"

namespace lightwell::server {

struct SchedulerOptions {
  std::filesystem::path worker_program, task_folder, blob_folder;
  uint32_t workers = 1;
  uint32_t threads_per_worker = 1;
  uint64_t max_job_memory_bytes = 0;
  double max_job_wall_s = 0;
  uint64_t min_free_disk_bytes = 0;  // no job starts with less
};

/// What happened, for logs and metrics.
struct SchedulerEvents {
  std::function<void(const v1::Job&)> started;
  std::function<void(const std::string& id, const Ending& ending, double seconds)> ended;
  std::function<void(const std::string& what)> trouble;
};

/// A rough upper estimate of what a job's worker will need, from the size of its files and of its light map.
uint64_t estimatedMemoryBytes(const v1::JobSpec& spec);

class Scheduler {
 public:
  Scheduler(const SchedulerOptions& options, Jobs& jobs, JobStore& store, BlobStore& blobs, SchedulerEvents events);
  /// Ends the workers (within a second) and queues their jobs again.
  ~Scheduler();
  Scheduler(const Scheduler&) = delete;
  Scheduler& operator=(const Scheduler&) = delete;

 private:
  void slot();
  /// The next job, already running; none when nothing can start now.
  std::optional<v1::Job> take();
  /// Why the job cannot start now; empty when it can.
  std::string obstacle(const v1::Job& job);
  void run(const v1::Job& job);
  /// What a killed worker left of half-written task results.
  void removeTemporaries(pid_t pid) const;
  Ending endingOf(const v1::Job& job, const WorkerEnd& end, uint64_t memory_limit, double wall_limit);
  v1::WorkerRequest requestOf(const v1::Job& job, uint64_t memory_limit) const;

  const SchedulerOptions options_;
  Jobs& jobs_;
  JobStore& store_;
  BlobStore& blobs_;
  const SchedulerEvents events_;
  std::mutex taking_;
  std::map<std::string, uint64_t> running_estimates_;  // guarded by taking_
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> slots_;
};

}  // namespace lightwell::server
