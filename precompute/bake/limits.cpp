#include "precompute/bake/limits.h"

#include <algorithm>
#include <array>

namespace lightwell::bake {
namespace {

using Clock = std::chrono::steady_clock;

/// A better quality is begun only if this many times the last one's duration still fits before the deadline.
constexpr double kNextQualityCost = 2.0;

/// Errors differ much from light to light, by its distance to the nearest surface: fewer would make their median a matter of luck.
constexpr uint32_t kTestLights = 16;

class Attempts {
 public:
  Attempts(const BakeContext& context, const Limits& limits, const std::vector<Warning>& warnings, TaskRunner& tasks,
           const AttemptListener& listener)
      : context_(context), limits_(limits), tasks_(tasks), listener_(listener), warnings_(warnings) {}

  /// Replaces the outcome; its phases and counts add up over attempts. Throws DeadlinePassed, keeping the last outcome.
  void run(const plan::Settings& settings, bool time_limited, Clock::time_point deadline) {
    const BakeGraph graph =
        makeBakeGraph(context_, {.settings = settings,
                                 .warnings = warnings_,
                                 .test_lights = settings.quality != plan::Quality::draft || limits_.target_error ? kTestLights : 0,
                                 .time_limited = time_limited},
                      tasks_);
    const RunResult result = tasks_.run(graph.graph, std::array{graph.container}, deadline);
    outcome.container = result.goals[0];
    outcome.omitted = graph.omitted;
    outcome.settings = settings;
    outcome.time_limited = time_limited;
    outcome.tasks_run = tasks_.tasksRun();
    outcome.tasks_reused = tasks_.tasksReused();
    if (const auto measured = error(); measured && listener_.measured) listener_.measured(*measured);
    for (const auto& phase : result.phases) {
      const auto known = std::find_if(outcome.phases.begin(), outcome.phases.end(), [&](const auto& p) { return p.name == phase.name; });
      if (known == outcome.phases.end())
        outcome.phases.push_back(phase);
      else
        known->seconds += phase.seconds;
    }
  }
  uint64_t bytes() const { return outcome.container->size(); }
  /// The measured error of the last attempt; none when nothing could be measured.
  std::optional<double> error() const {
    const auto meta = format::Reader(*outcome.container).meta();
    std::optional<double> largest;  // of what gives light to surfaces; of a sky the number of cells is the game's to choose, who draws them all in each frame
    for (const auto& error : meta.errors())
      if (error.section() != "environment") largest = std::max(largest.value_or(0.0), error.relrmse());
    if (largest) return largest;
    return std::nullopt;
  }
  Outcome outcome;

 private:
  const BakeContext& context_;
  const Limits& limits_;
  TaskRunner& tasks_;
  const AttemptListener& listener_;
  const std::vector<Warning>& warnings_;
};

/// From a draft up to the quality asked for, as far as time allows.
void runAgainstTheClock(Attempts& attempts, const plan::Settings& wanted, Clock::time_point deadline,
                        const std::function<void(const std::string&)>& announce) {
  plan::Settings settings = wanted;
  for (int quality = 0; quality <= int(wanted.quality); ++quality) {
    settings.quality = plan::Quality(quality);
    const auto begin = Clock::now();
    try {
      attempts.run(settings, settings.quality != wanted.quality, quality == 0 ? Clock::time_point::max() : deadline);
    } catch (const DeadlinePassed&) {
      announce("time is up: the container keeps quality " + std::string(plan::name(attempts.outcome.settings.quality)));
      return;
    }
    const auto next_end = Clock::now() + std::chrono::duration_cast<Clock::duration>((Clock::now() - begin) * kNextQualityCost);
    if (quality < int(wanted.quality)) {
      if (next_end > deadline) return;
      announce("quality " + std::string(plan::name(settings.quality)) + " is done; trying a better one in the time left");
    }
  }
}

}  // namespace

Outcome bakeWithin(const BakeContext& context, const Limits& limits, const std::vector<Warning>& warnings, Diagnostics& diagnostics,
                   TaskRunner& tasks, const AttemptListener& listener) {
  const auto say = [&](const std::string& text) {
    if (listener.announce) listener.announce(text);
  };
  const auto never = Clock::time_point::max();
  const Clock::time_point deadline = limits.deadline.value_or(never);
  Attempts attempts(context, limits, warnings, tasks, listener);
  plan::Settings settings = context.settings();
  if (limits.deadline)
    runAgainstTheClock(attempts, settings, deadline, say);
  else
    attempts.run(settings, false, never);
  settings = attempts.outcome.settings;

  if (limits.target_error && !attempts.outcome.time_limited) {
    auto error = attempts.error();
    try {
      while (error && *error > *limits.target_error && settings.refinement < plan::kFinestRefinement) {
        say("measured error " + std::to_string(*error) + ", wanted " + std::to_string(*limits.target_error) + ": refining");
        ++settings.refinement;
        attempts.run(settings, false, deadline);
        error = attempts.error();
      }
    } catch (const DeadlinePassed&) {
      say("time is up: the container keeps the error that it has");
      settings = attempts.outcome.settings;
    }
    if (!error) diagnostics.warn("", "--target-error: nothing that can be refined was measured: no light, no surface, or a sky alone, whose cells --environment-samples sets");
    if (error && *error > *limits.target_error)
      diagnostics.warn(
          "", "the measured error is " + std::to_string(*error) + ", not the " + std::to_string(*limits.target_error) + " asked for");
  }
  if (limits.size_limit_bytes) {
    while (attempts.bytes() > *limits.size_limit_bytes && settings.refinement > plan::kCoarsestRefinement) {
      say(std::to_string(attempts.bytes()) + " bytes, at most " + std::to_string(*limits.size_limit_bytes) + " allowed: coarsening");
      --settings.refinement;
      attempts.run(settings, attempts.outcome.time_limited, never);
    }
    if (attempts.bytes() > *limits.size_limit_bytes)
      throw UsageError("--size-limit: the smallest container of this scene at this --lightmap-size has " +
                       std::to_string(attempts.bytes()) + " bytes");
  }
  return attempts.outcome;
}

}  // namespace lightwell::bake
