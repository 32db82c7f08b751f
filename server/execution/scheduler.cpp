#include "server/execution/scheduler.h"

#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>

#include "precompute/plan/settings.h"
#include "server/failure.h"

namespace lightwell::server {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;
constexpr double kIdleWait_s = 1;            // between looks at the machine when jobs wait for memory or disk
constexpr uint32_t kMostInterruptions = 3;   // then a worker that something keeps killing is given up

uint64_t availableMemoryBytes() {
  std::ifstream meminfo("/proc/meminfo");
  for (std::string word; meminfo >> word;)
    if (word == "MemAvailable:") {
      uint64_t kilobytes = 0;
      meminfo >> kilobytes;
      return kilobytes * 1024;
    }
  return ~uint64_t(0);
}

std::string megabytes(uint64_t bytes) { return std::to_string(bytes / 1000000) + " MB"; }

Ending failedEnding(const char* id, const std::string& message, const std::string& stderr_tail = {}) {
  Ending ending;
  ending.error.set_id(id);
  ending.error.set_message(message);
  ending.error.set_stderr_tail(stderr_tail);
  return ending;
}

}  // namespace

uint64_t estimatedMemoryBytes(const v1::JobSpec& spec) {
  // Fitted to measured peaks of five scenes in all qualities (docs/service.md): 0.6 to 1.7 times of what they took. What matters most is
  // seen only during the bake: how full the atlas is, and how much of the scene each texel sees. The hard limit is for the rest.
  struct Cost {
    uint64_t base, per_texel;
  };
  constexpr Cost kCost[] = {{75'000'000, 3200}, {150'000'000, 4000}, {150'000'000, 7000}};  // draft, preview, production
  constexpr uint64_t kPerFileByte = 20;
  const plan::Settings settings = plan::settingsFromJson(spec.settings_json().empty() ? "{}" : spec.settings_json());
  const Cost& cost = kCost[int(settings.quality)];
  uint64_t bytes = cost.base + uint64_t(settings.lightmap_size) * uint64_t(settings.lightmap_size) * cost.per_texel;
  for (const auto& file : spec.files()) bytes += file.size() * kPerFileByte;
  return bytes;
}

Scheduler::Scheduler(const SchedulerOptions& options, Jobs& jobs, JobStore& store, BlobStore& blobs, SchedulerEvents events)
    : options_(options), jobs_(jobs), store_(store), blobs_(blobs), events_(std::move(events)) {
  for (uint32_t i = 0; i < options.workers; ++i) slots_.emplace_back([this] { slot(); });
}

Scheduler::~Scheduler() {
  stopping_ = true;
  jobs_.wakeAll();
  for (auto& slot : slots_) slot.join();
}

void Scheduler::slot() {
  while (!stopping_) {
    try {
      if (const auto job = take()) {
        run(*job);
        std::lock_guard lock(taking_);
        running_estimates_.erase(job->id());
      } else if (!stopping_) {
        jobs_.waitForWork(kIdleWait_s);
      }
    } catch (const std::exception& error) {  // the disk is full, say: the jobs are safe where they are
      events_.trouble(error.what());
      if (!stopping_) jobs_.waitForWork(kIdleWait_s);
    }
  }
}

std::optional<v1::Job> Scheduler::take() {
  std::lock_guard lock(taking_);
  while (!stopping_) {
    const auto job = jobs_.next();
    if (!job) return std::nullopt;
    if (jobs_.answerFromCache(job->id())) continue;
    const uint64_t limit = job->spec().limits().memory_bytes() ? job->spec().limits().memory_bytes() : options_.max_job_memory_bytes;
    const uint64_t estimate = estimatedMemoryBytes(job->spec());
    if (limit && estimate > limit) {
      Ending ending = failedEnding("memory_limit", "the job needs about " + megabytes(estimate) + " of memory; its limit is " + megabytes(limit));
      jobs_.finish(job->id(), ending);
      events_.ended(job->id(), ending, 0);
      continue;
    }
    if (const std::string why = obstacle(*job); !why.empty()) {
      jobs_.setWaiting(job->id(), why);
      return std::nullopt;
    }
    if (!jobs_.start(job->id())) continue;
    running_estimates_[job->id()] = estimate;
    return job;
  }
  return std::nullopt;
}

std::string Scheduler::obstacle(const v1::Job& job) {
  std::error_code error;
  const auto space = fs::space(options_.blob_folder, error);
  if (!error && space.available < options_.min_free_disk_bytes) return "disk space: only " + megabytes(space.available) + " are free";
  // What the running ones have not taken yet counts as taken. With nothing running there is nothing to wait for.
  uint64_t promised = 0;
  for (const auto& [id, bytes] : running_estimates_) {
    const uint64_t taken = jobs_.get(id, "")->progress().memory_bytes();
    promised += bytes > taken ? bytes - taken : 0;
  }
  const uint64_t available = availableMemoryBytes(), estimate = estimatedMemoryBytes(job.spec());
  if (!running_estimates_.empty() && promised + estimate > available)
    return "memory: about " + megabytes(estimate) + " needed, " + megabytes(available > promised ? available - promised : 0) + " free";
  return {};
}

v1::WorkerRequest Scheduler::requestOf(const v1::Job& job, uint64_t memory_limit) const {
  v1::WorkerRequest request;
  *request.mutable_spec() = job.spec();
  for (const auto& file : job.spec().files()) {
    if (!blobs_.size(file.sha256())) throw Failure(FailureId::missing_file, "\"" + file.name() + "\" is not in the store any more");
    request.add_file_paths(blobs_.fileOf(file.sha256()).string());
  }
  request.set_task_folder(options_.task_folder.string());
  request.set_blob_folder(options_.blob_folder.string());
  request.set_threads(job.spec().threads() ? std::min(job.spec().threads(), options_.threads_per_worker) : options_.threads_per_worker);
  request.set_memory_bytes(memory_limit);
  return request;
}

void Scheduler::run(const v1::Job& job) {
  const auto least = [](auto wanted, auto cap) { return wanted > 0 && (cap <= 0 || wanted < cap) ? wanted : cap; };
  const uint64_t memory_limit = least(job.spec().limits().memory_bytes(), options_.max_job_memory_bytes);
  const double wall_limit = least(job.spec().limits().wall_s(), options_.max_job_wall_s);
  events_.started(job);
  const auto begin = Clock::now();
  Ending ending;
  try {
    WorkerProcess worker(options_.worker_program, requestOf(job, memory_limit));
    const pid_t pid = worker.pid();
    const auto event = [&](const v1::WorkerEvent& event) {
      if (event.has_progress()) jobs_.setProgress(job.id(), event.progress());
      if (event.has_warning()) jobs_.addWarning(job.id(), event.warning());
    };
    const auto should_stop = [&] { return stopping_ || jobs_.cancelRequested(job.id()); };
    const WorkerEnd end = worker.wait({.wall_s = wall_limit, .memory_bytes = memory_limit}, event, should_stop);
    removeTemporaries(pid);
    ending = endingOf(job, end, memory_limit, wall_limit);
  } catch (const Failure& failure) {
    ending = failedEnding(name(failure.id), failure.what());
  } catch (const StoreError& error) {
    ending = failedEnding(error.diskFull() ? "disk_full" : "internal", error.what());
  } catch (const std::exception& error) {
    ending = failedEnding("internal", error.what());
  }
  // A full disk must not make a job that ended one that never does; a restart would run it again, from finished tasks.
  for (bool written = false; !written;) {
    try {
      jobs_.finish(job.id(), ending);
      written = true;
    } catch (const StoreError& error) {
      events_.trouble(error.what());
      if (stopping_) break;
      std::this_thread::sleep_for(std::chrono::duration<double>(kIdleWait_s));
    }
  }
  events_.ended(job.id(), ending, std::chrono::duration<double>(Clock::now() - begin).count());
}

void Scheduler::removeTemporaries(pid_t pid) const {
  const std::string mark = std::string(".").append(std::to_string(pid)).append(".");
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(options_.task_folder / "tmp", error))
    if (entry.path().filename().string().find(mark) != std::string::npos) fs::remove(entry.path(), error);
}

Ending Scheduler::endingOf(const v1::Job& job, const WorkerEnd& end, uint64_t memory_limit, double wall_limit) {
  Ending ending;
  if (end.last.has_done() && end.signal == 0) {
    ending.state = v1::JOB_STATE_SUCCEEDED;
    ending.result = end.last.done().result();
    ending.reusable = !end.last.done().depends_on_time();
    store_.addBlob(ending.result.sha256(), ending.result.size(), "");
    if (const std::string& preview = ending.result.preview_sha256(); !preview.empty())
      store_.addBlob(preview, blobs_.size(preview).value_or(0), "");
    return ending;
  }
  if (end.stopped) {
    // A cancelled job stays so; one that only the daemon's end stopped goes on later.
    ending.state = jobs_.cancelRequested(job.id()) ? v1::JOB_STATE_CANCELLED : v1::JOB_STATE_QUEUED;
    return ending;
  }
  if (end.timed_out)
    return failedEnding("time_limit", "the job did not end within " + std::to_string(int64_t(wall_limit)) + " s", end.stderr_tail);
  if (end.over_memory)
    return failedEnding("memory_limit", "the job's worker took more than " + megabytes(memory_limit) + " of memory", end.stderr_tail);
  if (end.heartbeat_lost) return failedEnding("worker_silent", "the job's worker gave no sign of life", end.stderr_tail);
  if (end.last.has_failed()) {
    ending.error = end.last.failed();
    ending.error.set_stderr_tail(end.stderr_tail);
    return ending;
  }
  if (end.signal == SIGKILL || end.signal == SIGTERM || end.signal == SIGINT) {
    // Not our doing: the kernel out of memory, or an operator. What is finished is kept, so going on costs little.
    if (store_.interruptions(job.id()) < kMostInterruptions) {
      ending.state = v1::JOB_STATE_QUEUED;
      return ending;
    }
    return failedEnding("worker_killed", "the job's worker was killed from outside again and again (signal " + std::to_string(end.signal) +
                                             "); the machine may be out of memory", end.stderr_tail);
  }
  if (end.signal)
    return failedEnding("worker_crashed", std::string("the job's worker crashed: ") + strsignal(end.signal), end.stderr_tail);
  return failedEnding("worker_crashed", "the job's worker ended without a result (exit code " + std::to_string(end.exit_code) + ")",
                      end.stderr_tail);
}

}  // namespace lightwell::server
