// Prometheus metrics of the daemon.
#pragma once
#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>

#include <string>

#include "server/store/job_store.h"

namespace lightwell::server {

/// Thread-safe.
class Metrics {
 public:
  explicit Metrics(const std::string& version);

  void submitted(double seconds) { submit_seconds_.Observe(seconds); }
  void ended(const Ending& ending, double seconds);
  /// What is looked at only when somebody asks.
  struct State {
    std::map<v1::JobState, int64_t> jobs;
    uint32_t watches = 0, uploads = 0;
    uint64_t store_bytes = 0, free_disk_bytes = 0;
  };
  /// The text exposition format.
  std::string text(const State& state);

 private:
  prometheus::Registry registry_;
  prometheus::Family<prometheus::Counter>&ended_, &failures_;
  prometheus::Family<prometheus::Gauge>&jobs_, &streams_, &bytes_;
  prometheus::Histogram &submit_seconds_, &job_seconds_;
  prometheus::Counter &tasks_run_, &tasks_reused_, &rays_;
};

}  // namespace lightwell::server
