// All jobs as the outside sees them: what is on disk, the progress of what is running, and who watches.
#pragma once
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <unordered_map>

#include "server/store/job_store.h"

namespace lightwell::server {

using JobPtr = std::shared_ptr<const v1::Job>;

/// Told of every change of one job, from any thread; returns at once. A state may arrive late, after the final one.
class JobWatcher {
 public:
  virtual ~JobWatcher() = default;
  virtual void jobChanged(const JobPtr& job) = 0;
};

/// Thread-safe. A client's name limits every call to that client's jobs; an empty one sees all.
class Jobs {
 public:
  explicit Jobs(JobStore& store) : store_(store) {}

  JobPtr submit(const Submission& submission, bool& created);
  /// Throws Failure job_not_found.
  JobPtr get(const std::string& id, const std::string& client);
  struct Page {
    std::vector<JobPtr> jobs;
    int64_t next = 0;
  };
  Page list(const std::string& client, const std::vector<v1::JobState>& states, const std::string& label, int64_t before, uint32_t count);
  std::map<v1::JobState, int64_t> counts() { return store_.counts(); }
  /// A queued job is cancelled on return; a running one soon after.
  JobPtr cancel(const std::string& id, const std::string& client);
  /// Throws Failure: job_not_found, job_unfinished.
  void remove(const std::string& id, const std::string& client);

  /// From now on the watcher hears of the job; returns its present state. Throws Failure job_not_found.
  JobPtr watch(const std::string& id, const std::string& client, const std::shared_ptr<JobWatcher>& watcher);
  void unwatch(const std::string& id, const std::shared_ptr<JobWatcher>& watcher);

  // ---- for the scheduler

  /// Waits until something may be startable, or `seconds` passed.
  void waitForWork(double seconds);
  void wakeAll();
  std::optional<v1::Job> next() { return store_.next(); }
  bool start(const std::string& id);
  bool answerFromCache(const std::string& id);
  bool cancelRequested(const std::string& id);
  void setWaiting(const std::string& id, const std::string& reason);
  void setProgress(const std::string& id, const v1::JobProgress& progress);
  void addWarning(const std::string& id, const v1::JobWarning& warning);
  /// Completes `ending` by progress and warnings that were seen.
  void finish(const std::string& id, Ending& ending);

 private:
  struct Live {
    v1::JobProgress progress;
    std::vector<v1::JobWarning> warnings;
    bool cancel_requested = false;
  };
  JobPtr load(const std::string& id, const std::string& client);
  JobPtr merged(v1::Job job);
  void publish(const std::string& id);

  JobStore& store_;
  std::mutex mutex_;
  std::condition_variable work_;
  uint64_t work_serial_ = 0;
  std::map<std::string, Live> live_;                // running jobs
  std::map<std::string, std::string> waiting_for_;  // queued jobs that wait for more than a worker
  std::unordered_map<std::string, std::set<std::shared_ptr<JobWatcher>>> watchers_;
};

}  // namespace lightwell::server
