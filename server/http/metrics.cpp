#include "server/http/metrics.h"

#include <prometheus/text_serializer.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "server/job/job_state.h"

namespace lightwell::server {
namespace {

using prometheus::BuildCounter;
using prometheus::BuildGauge;
using prometheus::BuildHistogram;

double residentBytes() {
  std::ifstream statm("/proc/self/statm");
  double pages = 0, resident = 0;
  statm >> pages >> resident;
  return resident * double(sysconf(_SC_PAGESIZE));
}

double openDescriptors() {
  std::error_code error;
  double count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd", error)) ++count;
  return count;
}

}  // namespace

Metrics::Metrics(const std::string& version)
    : ended_(BuildCounter().Name("lightwelld_jobs_ended_total").Help("Attempts of jobs, by the state they ended in").Register(registry_)),
      failures_(BuildCounter().Name("lightwelld_job_failures_total").Help("Failed jobs, by error id").Register(registry_)),
      jobs_(BuildGauge().Name("lightwelld_jobs").Help("Jobs in the store, by state").Register(registry_)),
      streams_(BuildGauge().Name("lightwelld_streams").Help("Open streams").Register(registry_)),
      bytes_(BuildGauge().Name("lightwelld_bytes").Help("Bytes of the store, free on its disk, and of the daemon's memory").Register(registry_)),
      submit_seconds_(BuildHistogram().Name("lightwelld_submit_seconds").Help("From a submit's arrival to its durable answer").Register(registry_)
                          .Add({}, prometheus::Histogram::BucketBoundaries{.001, .002, .005, .01, .02, .05, .1, .2, .5, 1, 2, 5})),
      job_seconds_(BuildHistogram().Name("lightwelld_job_seconds").Help("Running time of attempts").Register(registry_)
                       .Add({}, prometheus::Histogram::BucketBoundaries{.1, .3, 1, 3, 10, 30, 100, 300, 1000, 3000, 10000})),
      tasks_run_(BuildCounter().Name("lightwelld_tasks_run_total").Help("Tasks that ended attempts ran").Register(registry_).Add({})),
      tasks_reused_(BuildCounter().Name("lightwelld_tasks_reused_total").Help("Tasks whose result was in the store").Register(registry_).Add({})),
      rays_(BuildCounter().Name("lightwelld_rays_total").Help("Rays traced by ended attempts").Register(registry_).Add({})) {
  BuildGauge().Name("lightwelld_info").Help("Always 1").Register(registry_).Add({{"version", version}}).Set(1);
}

void Metrics::ended(const Ending& ending, double seconds) {
  ended_.Add({{"state", name(ending.state)}}).Increment();
  if (ending.state == v1::JOB_STATE_FAILED) failures_.Add({{"error", ending.error.id()}}).Increment();
  job_seconds_.Observe(seconds);
  tasks_run_.Increment(double(ending.progress.tasks_done() - std::min(ending.progress.tasks_reused(), ending.progress.tasks_done())));
  tasks_reused_.Increment(double(ending.progress.tasks_reused()));
  rays_.Increment(double(ending.progress.rays()));
}

std::string Metrics::text(const State& state) {
  for (const auto s : {v1::JOB_STATE_QUEUED, v1::JOB_STATE_RUNNING, v1::JOB_STATE_SUCCEEDED, v1::JOB_STATE_FAILED, v1::JOB_STATE_CANCELLED})
    jobs_.Add({{"state", name(s)}}).Set(state.jobs.contains(s) ? double(state.jobs.at(s)) : 0);
  streams_.Add({{"kind", "watch"}}).Set(state.watches);
  streams_.Add({{"kind", "upload"}}).Set(state.uploads);
  streams_.Add({{"kind", "descriptor"}}).Set(openDescriptors());
  bytes_.Add({{"of", "store"}}).Set(double(state.store_bytes));
  bytes_.Add({{"of", "free_disk"}}).Set(double(state.free_disk_bytes));
  bytes_.Add({{"of", "memory"}}).Set(residentBytes());
  return prometheus::TextSerializer().Serialize(registry_.Collect());
}

}  // namespace lightwell::server
