#include "precompute/bake/run.h"

#include <sys/resource.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>

namespace lightwell::bake {
namespace {

using Clock = std::chrono::steady_clock;

uint64_t peakMemoryBytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return uint64_t(usage.ru_maxrss) * 1024;
}

uint64_t raysOf(const std::optional<BakeContext>& context) {
  if (!context || !context->tracer()) return 0;
  const auto counts = context->tracer()->counts();
  return counts.closest + counts.occlusion;
}

Limits limitsOf(const Request& request, Clock::time_point begin) {
  Limits limits{.deadline = {}, .target_error = request.target_error, .size_limit_bytes = request.size_limit_bytes};
  if (request.time_limit_s)
    limits.deadline = begin + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(*request.time_limit_s));
  return limits;
}

/// Into the measured errors of the container, if that leaves it within its limit.
void recordSeconds(const std::map<std::string, double>& section_seconds, const Limits& limits, Blob& container, Diagnostics& diagnostics) {
  const format::Reader reader(*container);
  v1::MetaHeader meta = reader.meta();
  for (auto& error : *meta.mutable_errors())
    if (const auto seconds = section_seconds.find(error.section()); seconds != section_seconds.end()) error.set_seconds(seconds->second);
  format::Writer writer;
  for (const auto& section : reader.view().sections()) writer.addSection(section.type, section.version, section.required);
  for (const auto& chunk : reader.view().chunks())
    if (chunk.section == "meta" && chunk.name == "header") writer.addMessage("meta", "header", meta);
    else writer.addStored(chunk, std::span(*container).subspan(chunk.offset, chunk.stored_bytes));
  auto bytes = std::make_shared<Bytes>(writer.bytes());
  if (limits.size_limit_bytes && bytes->size() > *limits.size_limit_bytes) return diagnostics.warn("", "--record-seconds: the seconds do not fit into --size-limit");
  container = std::move(bytes);
}

}  // namespace

Baked runBake(const Request& request, ResultStore& store, Diagnostics& run_diagnostics, const CancelFlag& cancel,
              const Listener& listener) {
  const auto begin = Clock::now();
  const Limits limits = limitsOf(request, begin);
  Diagnostics diagnostics;
  ThreadExecutor executor(request.threads);
  std::optional<BakeContext> context;
  RunOptions options{.cancel = &cancel};
  if (listener.progress) options.progress = [&](const Progress& progress) { listener.progress(progress, raysOf(context)); };
  TaskRunner tasks(executor, store, options);
  context.emplace(request.source, request.settings, request.threads, diagnostics, cancel, listener.stage, &tasks);
  Baked baked;
  Report& report = baked.report;
  report.warnings = diagnostics.warnings();
  if (listener.warning)
    for (const auto& warning : report.warnings) listener.warning(warning);
  baked.outcome = bakeWithin(*context, limits, report.warnings, run_diagnostics, tasks, listener.attempts);
  if (request.record_seconds) recordSeconds(tasks.sectionSeconds(), limits, baked.outcome.container, run_diagnostics);

  report.phases = context->stageTimes();
  report.phases.insert(report.phases.end(), baked.outcome.phases.begin(), baked.outcome.phases.end());
  const format::Reader reader(*baked.outcome.container);
  report.sections = sectionSizes(reader);
  const auto meta = reader.meta();
  report.errors.assign(meta.errors().begin(), meta.errors().end());
  for (auto& error : report.errors)
    if (const auto seconds = tasks.sectionSeconds().find(error.section()); seconds != tasks.sectionSeconds().end()) error.set_seconds(seconds->second);
  const auto of_run = run_diagnostics.warnings();
  report.warnings.insert(report.warnings.end(), of_run.begin(), of_run.end());
  report.rays = raysOf(context);
  report.peak_memory_bytes = peakMemoryBytes();
  report.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return baked;
}

nlohmann::json errorJson(const v1::MeasuredError& e) {
  nlohmann::json error{{"section", e.section()}, {"relrmse", e.relrmse()}, {"texrel", e.texrel()}, {"bias", e.bias()}, {"against", e.against()}};
  if (e.relrmse_high() > 0) error["relrmse_interval"] = {e.relrmse_low(), e.relrmse_high()};
  if (e.texrel_high() > 0) error["texrel_interval"] = {e.texrel_low(), e.texrel_high()};
  if (e.bias_low() != 0 || e.bias_high() != 0) error["bias_interval"] = {e.bias_low(), e.bias_high()};
  if (e.maximum() > 0 || e.maximum_high() > 0) error["maximum"] = e.maximum();
  if (e.maximum_high() > 0) error["maximum_interval"] = {e.maximum_low(), e.maximum_high()};
  if (e.texels() > 0) error["texels"] = e.texels();
  if (e.seconds() > 0) error["seconds"] = e.seconds();
  return error;
}

nlohmann::json reportJson(const Baked& baked) {
  using nlohmann::json;
  const auto& [outcome, report] = baked;
  json document{{"seconds", report.seconds},
                {"rays", report.rays},
                {"bytes", outcome.container->size()},
                {"tasks_run", outcome.tasks_run},
                {"tasks_reused", outcome.tasks_reused},
                {"peak_memory_bytes", report.peak_memory_bytes},
                {"settings", json::parse(plan::canonicalJson(outcome.settings))},
                {"time_limited", outcome.time_limited},
                {"error", nullptr}};
  for (const char* key : {"sections", "omitted", "phases", "warnings"}) document[key] = json::array();
  if (!report.errors.empty()) document["error"] = json::array();
  for (const auto& e : report.errors)
    document["error"].push_back(errorJson(e));
  for (const auto& s : report.sections)
    document["sections"].push_back({{"type", s.type}, {"stored_bytes", s.stored_bytes}, {"raw_bytes", s.raw_bytes}});
  for (const auto& o : outcome.omitted)
    document["omitted"].push_back({{"type", o.type}, {"reason", o.reason}, {"decoded_bytes", o.decoded_bytes}, {"rays", o.rays}});
  for (const auto& p : report.phases) document["phases"].push_back({{"name", p.name}, {"seconds", p.seconds}});
  for (const auto& w : report.warnings) document["warnings"].push_back({{"place", w.place}, {"message", w.message}});
  return document;
}

}  // namespace lightwell::bake
