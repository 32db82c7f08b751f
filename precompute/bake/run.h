// One whole bake, from a request to a container and a report: what the command and the service's workers both run.
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "precompute/bake/limits.h"

namespace lightwell::bake {

struct Request {
  SceneSource source;
  plan::Settings settings;
  std::optional<double> time_limit_s, target_error;  // Limits explains them; time counts from the start of runBake()
  std::optional<uint64_t> size_limit_bytes;
  bool record_seconds = false;                       // beside the measured errors in the container, whose bytes are then another's in each bake
  int threads = 0;                                   // 0: one per processor. No influence on the bytes
};

/// What is told while a bake runs. Members may be empty; each is called from one thread at a time.
struct Listener {
  std::function<void(const std::string& stage)> stage;   // before the tasks: import, atlas, …
  std::function<void(const Warning&)> warning;           // a repair of the scene, as soon as the scene is read
  std::function<void(const Progress&, uint64_t rays)> progress;  // tasks of preparing stages included
  AttemptListener attempts;
};

/// What a bake tells about itself besides its Outcome.
struct Report {
  double seconds = 0;
  uint64_t rays = 0;
  uint64_t peak_memory_bytes = 0;  // of the whole process
  std::vector<SectionSize> sections;
  std::vector<PhaseTime> phases;   // the stages before the tasks included
  std::vector<v1::MeasuredError> errors;
  std::vector<Warning> warnings;   // of the scene, then of this run alone, which no container mentions
};

struct Baked {
  Outcome outcome;
  Report report;
};

/// Throws InputError, UsageError or Cancelled. `run_diagnostics` are those that the store was made with.
Baked runBake(const Request& request, ResultStore& store, Diagnostics& run_diagnostics, const CancelFlag& cancel,
              const Listener& listener);

/// One measured error, as reports and `info` give it.
nlohmann::json errorJson(const v1::MeasuredError& error);
/// schemas/bake.schema.json without "output".
nlohmann::json reportJson(const Baked& baked);

}  // namespace lightwell::bake
