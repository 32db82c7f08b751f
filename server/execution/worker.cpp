#include "server/execution/worker.h"

#include <fcntl.h>
#include <pthread.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "precompute/bake/run.h"
#include "precompute/core/sanitizer.h"
#include "server/store/blob_store.h"
#include "server/execution/framing.h"
#include "server/execution/preview.h"

namespace lightwell::server {
namespace {

using Clock = std::chrono::steady_clock;
constexpr auto kHeartbeat = std::chrono::milliseconds(500);

/// A process that nobody waits for any more, that shares the machine kindly, and that is the first to go when memory runs out.
void becomeWorker(uint64_t memory_bytes) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  signal(SIGPIPE, SIG_IGN);
  setpriority(PRIO_PROCESS, 0, 10);
  std::ofstream("/proc/self/oom_score_adj") << 900;
  prctl(PR_SET_DUMPABLE, 0);  // after the line above: it takes our own files in /proc away from us
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  if (memory_bytes > 0 && !kSanitized) {
    // Of what is really allocated: address space that Embree or TBB only reserve does not count. A sanitizer's shadow of it does.
    const rlimit data{rlim_t(memory_bytes), rlim_t(memory_bytes)};
    setrlimit(RLIMIT_DATA, &data);
  }
}

uint64_t residentBytes() {
  std::ifstream statm("/proc/self/statm");
  uint64_t pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * uint64_t(sysconf(_SC_PAGESIZE));
}

/// Sends events, and the newest progress twice a second, whatever the bake is doing.
class Reporter {
 public:
  Reporter() : thread_([this] { beat(); }) {}
  ~Reporter() {
    {
      std::lock_guard lock(mutex_);
      ended_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }
  void send(const v1::WorkerEvent& event) {
    std::lock_guard lock(pipe_);
    writeMessage(kEventDescriptor, event);
  }
  /// Changes the progress that the next heartbeat sends.
  template <class Change>
  void update(const Change& change) {
    std::lock_guard lock(mutex_);
    change(progress_);
  }

 private:
  void beat() {
    std::unique_lock lock(mutex_);
    for (bool last = false; !last;) {
      last = ended_;  // the end is told too
      progress_.set_elapsed_s(std::chrono::duration<double>(Clock::now() - begin_).count());
      progress_.set_memory_bytes(residentBytes());
      const double window_s = std::chrono::duration<double>(Clock::now() - rays_at_).count();
      if (window_s > 0.4) {
        progress_.set_rays_per_second(double(progress_.rays() - std::min(progress_.rays(), rays_before_)) / window_s);
        rays_before_ = progress_.rays();
        rays_at_ = Clock::now();
      }
      v1::WorkerEvent event;
      *event.mutable_progress() = progress_;
      lock.unlock();
      send(event);
      lock.lock();
      if (!last) changed_.wait_for(lock, kHeartbeat, [this] { return ended_; });
    }
  }
  const Clock::time_point begin_ = Clock::now();
  std::mutex mutex_, pipe_;
  std::condition_variable changed_;
  v1::JobProgress progress_;
  uint64_t rays_before_ = 0;
  Clock::time_point rays_at_ = begin_;
  bool ended_ = false;
  std::thread thread_;
};

bake::Request requestOf(const v1::WorkerRequest& request) {
  const v1::JobSpec& spec = request.spec();
  bake::Request bake;
  bake.settings = plan::settingsFromJson(spec.settings_json().empty() ? "{}" : spec.settings_json());
  scene::FileTable files;
  for (int i = 0; i < spec.files_size(); ++i) files[spec.files(i).name()] = request.file_paths(i);
  bake.source.scene = spec.scene();
  if (!spec.lights().empty()) bake.source.lights = spec.lights();
  if (!spec.environment().empty()) bake.source.environment = spec.environment();
  bake.source.files = std::move(files);
  if (spec.time_limit_s() > 0) bake.time_limit_s = spec.time_limit_s();
  if (spec.target_error() > 0) bake.target_error = spec.target_error();
  if (spec.size_limit_bytes() > 0) bake.size_limit_bytes = spec.size_limit_bytes();
  bake.threads = int(request.threads());
  return bake;
}

v1::WorkerEvent failed(const char* id, const std::string& message) {
  v1::WorkerEvent event;
  event.mutable_failed()->set_id(id);
  event.mutable_failed()->set_message(message);
  return event;
}

v1::WorkerEvent bakeJob(const v1::WorkerRequest& request, const CancelFlag& cancel, Reporter& reporter) {
  bake::Listener listener;
  listener.stage = [&](const std::string& stage) { reporter.update([&](v1::JobProgress& p) { p.set_phase(stage), p.set_eta_s(-1); }); };
  listener.warning = [&](const Warning& warning) {
    v1::WorkerEvent event;
    event.mutable_warning()->set_place(warning.place);
    event.mutable_warning()->set_message(warning.message);
    reporter.send(event);
  };
  listener.attempts.announce = [&](const std::string& text) { fprintf(stderr, "%s\n", text.c_str()); };
  listener.attempts.measured = [&](double relrmse) { reporter.update([&](v1::JobProgress& p) { p.set_relrmse(relrmse); }); };
  listener.progress = [&](const bake::Progress& progress, uint64_t rays) {
    reporter.update([&](v1::JobProgress& p) {
      p.set_phase(progress.phase);
      p.set_tasks_done(progress.tasks_done);
      p.set_tasks_total(progress.tasks_total);
      p.set_tasks_reused(progress.tasks_reused);
      p.set_fraction(progress.fraction);
      p.set_eta_s(progress.eta_s);
      p.set_rays(rays);
    });
  };
  try {
    Diagnostics run_diagnostics;
    bake::DirectoryStore store(request.task_folder(), run_diagnostics);
    const bake::Baked baked = bake::runBake(requestOf(request), store, run_diagnostics, cancel, listener);
    BlobStore blobs(request.blob_folder());
    v1::WorkerEvent event;
    v1::JobResult& result = *event.mutable_done()->mutable_result();
    result.set_sha256(blobs.put(*baked.outcome.container));
    result.set_size(baked.outcome.container->size());
    result.set_report_json(bake::reportJson(baked).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    if (const auto png = previewPng(*baked.outcome.container); !png.empty()) result.set_preview_sha256(blobs.put(png));
    event.mutable_done()->set_depends_on_time(request.spec().time_limit_s() > 0 && baked.outcome.time_limited);
    reporter.update([&](v1::JobProgress& p) { p.set_fraction(1), p.set_eta_s(0); });
    return event;
  } catch (const Cancelled&) {
    return failed("cancelled", "interrupted");
  } catch (const InputError& error) {
    return failed("input_rejected", error.what());
  } catch (const UsageError& error) {
    return failed("invalid_settings", error.what());
  } catch (const std::bad_alloc&) {
    return failed("memory_limit", "the bake needs more memory than its limit of " + std::to_string(request.memory_bytes()) + " bytes");
  } catch (const std::exception& error) {
    const std::string reason = error.what();
    return failed(reason.find("No space left") != std::string::npos ? "disk_full" : "internal", reason);
  }
}

}  // namespace

int runWorker(const std::function<void(const v1::WorkerRequest&)>& before) {
  // Terminating signals are for one thread; the daemon's end, which closes our standard input, for another.
  static CancelFlag cancel;
  sigset_t terminating;
  sigemptyset(&terminating);
  sigaddset(&terminating, SIGTERM);
  sigaddset(&terminating, SIGINT);
  pthread_sigmask(SIG_BLOCK, &terminating, nullptr);
  std::thread([terminating] {
    int number = 0;
    sigwait(&terminating, &number);
    cancel.cancel();
  }).detach();

  v1::WorkerRequest request;
  MessageReader reader;
  if (!reader.readMessage(STDIN_FILENO, request)) return 2;
  becomeWorker(request.memory_bytes());
  std::thread([] {
    char byte;
    while (read(STDIN_FILENO, &byte, 1) > 0) {
    }
    _exit(3);
  }).detach();

  v1::WorkerEvent last;
  {
    Reporter reporter;
    if (before) before(request);
    last = bakeJob(request, cancel, reporter);
  }
  writeMessage(kEventDescriptor, last);
  // Nothing left to do that the end of the process does not do faster.
  _exit(last.has_done() ? 0 : 1);
}

}  // namespace lightwell::server
