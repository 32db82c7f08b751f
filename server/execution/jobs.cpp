#include "server/execution/jobs.h"

#include "server/failure.h"
#include "server/job/job_state.h"

namespace lightwell::server {

JobPtr Jobs::merged(v1::Job job) {
  std::lock_guard lock(mutex_);
  if (const auto live = live_.find(job.id()); live != live_.end() && job.state() == v1::JOB_STATE_RUNNING) {
    *job.mutable_progress() = live->second.progress;
    for (const auto& warning : live->second.warnings) *job.add_warnings() = warning;
  }
  if (const auto waiting = waiting_for_.find(job.id()); waiting != waiting_for_.end() && job.state() == v1::JOB_STATE_QUEUED)
    job.set_waiting_for(waiting->second);
  return std::make_shared<const v1::Job>(std::move(job));
}

JobPtr Jobs::load(const std::string& id, const std::string& client) {
  auto job = store_.get(id, client);
  if (!job) throw Failure(FailureId::job_not_found, "there is no job " + id);
  return merged(std::move(*job));
}

void Jobs::publish(const std::string& id) {
  {
    std::lock_guard lock(mutex_);
    if (!watchers_.contains(id)) return;
  }
  auto stored = store_.get(id);
  if (!stored) return;
  const JobPtr job = merged(std::move(*stored));
  std::vector<std::shared_ptr<JobWatcher>> watchers;
  {
    std::lock_guard lock(mutex_);
    if (const auto found = watchers_.find(id); found != watchers_.end()) watchers.assign(found->second.begin(), found->second.end());
  }
  for (const auto& watcher : watchers) watcher->jobChanged(job);
}

JobPtr Jobs::submit(const Submission& submission, bool& created) {
  auto submitted = store_.submit(submission);
  created = submitted.created;
  wakeAll();
  return merged(std::move(submitted.job));
}

JobPtr Jobs::get(const std::string& id, const std::string& client) { return load(id, client); }

Jobs::Page Jobs::list(const std::string& client, const std::vector<v1::JobState>& states, const std::string& label, int64_t before,
                      uint32_t count) {
  auto stored = store_.list(client, states, label, before, count);
  Page page{{}, stored.next};
  for (auto& job : stored.jobs) page.jobs.push_back(merged(std::move(job)));
  return page;
}

JobPtr Jobs::cancel(const std::string& id, const std::string& client) {
  const JobPtr job = load(id, client);
  if (isFinal(job->state())) return job;
  // On disk first: the wish survives a restart. Then the two places where the job may be.
  store_.requestCancel(id);
  if (store_.cancelQueued(id)) {
    publish(id);
    wakeAll();
  } else {
    std::lock_guard lock(mutex_);
    if (const auto live = live_.find(id); live != live_.end()) live->second.cancel_requested = true;
  }
  return load(id, client);
}

void Jobs::remove(const std::string& id, const std::string& client) {
  load(id, client);
  if (!store_.remove(id)) throw Failure(FailureId::job_unfinished, "the job is not finished; cancel it first");
}

JobPtr Jobs::watch(const std::string& id, const std::string& client, const std::shared_ptr<JobWatcher>& watcher) {
  load(id, client);
  {
    std::lock_guard lock(mutex_);
    watchers_[id].insert(watcher);
  }
  // Read again after the watcher is known: no change falls between.
  try {
    return load(id, client);
  } catch (...) {
    unwatch(id, watcher);
    throw;
  }
}

void Jobs::unwatch(const std::string& id, const std::shared_ptr<JobWatcher>& watcher) {
  std::lock_guard lock(mutex_);
  const auto found = watchers_.find(id);
  if (found == watchers_.end()) return;
  found->second.erase(watcher);
  if (found->second.empty()) watchers_.erase(found);
}

void Jobs::waitForWork(double seconds) {
  std::unique_lock lock(mutex_);
  const uint64_t seen = work_serial_;
  work_.wait_for(lock, std::chrono::duration<double>(seconds), [&] { return work_serial_ != seen; });
}

void Jobs::wakeAll() {
  std::lock_guard lock(mutex_);
  ++work_serial_;
  work_.notify_all();
}

bool Jobs::start(const std::string& id) {
  {
    std::lock_guard lock(mutex_);
    live_[id] = {};
    waiting_for_.erase(id);
  }
  const bool started = store_.start(id);
  if (!started) {
    std::lock_guard lock(mutex_);
    live_.erase(id);
  }
  publish(id);
  return started;
}

bool Jobs::answerFromCache(const std::string& id) {
  if (!store_.answerFromCache(id)) return false;
  publish(id);
  return true;
}

bool Jobs::cancelRequested(const std::string& id) {
  std::lock_guard lock(mutex_);
  const auto live = live_.find(id);
  return live != live_.end() && live->second.cancel_requested;
}

void Jobs::setWaiting(const std::string& id, const std::string& reason) {
  {
    std::lock_guard lock(mutex_);
    std::string& known = waiting_for_[id];
    if (known == reason) return;
    known = reason;
  }
  publish(id);
}

void Jobs::setProgress(const std::string& id, const v1::JobProgress& progress) {
  {
    std::lock_guard lock(mutex_);
    if (const auto live = live_.find(id); live != live_.end()) live->second.progress = progress;
  }
  publish(id);
}

void Jobs::addWarning(const std::string& id, const v1::JobWarning& warning) {
  constexpr size_t kMostWarnings = 100;
  {
    std::lock_guard lock(mutex_);
    const auto live = live_.find(id);
    if (live == live_.end() || live->second.warnings.size() >= kMostWarnings) return;
    live->second.warnings.push_back(warning);
  }
  publish(id);
}

void Jobs::finish(const std::string& id, Ending& ending) {
  {
    std::lock_guard lock(mutex_);
    if (const auto live = live_.find(id); live != live_.end()) {
      ending.progress = live->second.progress;
      ending.warnings = live->second.warnings;
    }
  }
  store_.finish(id, ending);
  {
    std::lock_guard lock(mutex_);
    live_.erase(id);
    waiting_for_.erase(id);
  }
  publish(id);
  wakeAll();
}

}  // namespace lightwell::server
