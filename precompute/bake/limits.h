// Bakes with a limit of time or size, or an error to reach: the same graph at another quality, until the answer fits.
#pragma once
#include <chrono>
#include <functional>
#include <optional>

#include "precompute/bake/bake.h"

namespace lightwell::bake {

struct Limits {
  /// Drafts are finished whatever they take; better qualities only if they end in time. The one thing that makes bytes depend on the
  /// machine's speed: the container says so when its quality is not the one asked for.
  std::optional<std::chrono::steady_clock::time_point> deadline;
  /// Measured relrmse, the largest of the techniques': refined up to plan::kFinestRefinement until it is reached, else there is a warning.
  std::optional<double> target_error;
  /// Of the file: coarsened down to plan::kCoarsestRefinement until it fits, else a UsageError names the smallest size. Stronger than the
  /// target.
  std::optional<uint64_t> size_limit_bytes;
};

struct Outcome {
  Blob container;
  std::vector<plan::Omitted> omitted;
  std::vector<PhaseTime> phases;  // of all attempts together
  size_t tasks_run = 0, tasks_reused = 0;
  plan::Settings settings;        // as baked
  bool time_limited = false;
};

/// What is told on the way; members may be empty.
struct AttemptListener {
  std::function<void(const std::string&)> announce;   // why another attempt begins, in words
  std::function<void(double relrmse)> measured;       // after each attempt that measured errors: the largest
};

/// Runs the graph at the quality of context.settings(), or at those that the limits lead to. `warnings` (of the scene) go into the
/// container; those about limits that were missed go to `diagnostics`. Throws as Executor::run, and UsageError.
Outcome bakeWithin(const BakeContext& context, const Limits& limits, const std::vector<Warning>& warnings, Diagnostics& diagnostics,
                   TaskRunner& tasks, const AttemptListener& listener);

}  // namespace lightwell::bake
