#include "server/job/job_json.h"

#include <nlohmann/json.hpp>

namespace lightwell::server {
namespace {

using nlohmann::json;

const char* stateName(v1::JobState state) {
  static constexpr const char* kNames[] = {"unknown", "queued", "running", "succeeded", "failed", "cancelled"};
  return state >= 0 && size_t(state) < std::size(kNames) ? kNames[state] : kNames[0];
}

/// Text written by our own programs; null for what is none of theirs.
json parsed(const std::string& text) {
  json value = json::parse(text, nullptr, false);
  return value.is_discarded() ? json(nullptr) : value;
}

json progressJson(const v1::JobProgress& p) {
  return {{"phase", p.phase()},
          {"tasks_done", p.tasks_done()},
          {"tasks_total", p.tasks_total()},
          {"tasks_reused", p.tasks_reused()},
          {"fraction", p.fraction()},
          {"elapsed_s", p.elapsed_s()},
          {"eta_s", p.eta_s() >= 0 ? json(p.eta_s()) : json(nullptr)},
          {"rays", p.rays()},
          {"rays_per_second", p.rays_per_second()},
          {"relrmse", p.has_relrmse() ? json(p.relrmse()) : json(nullptr)},
          {"memory_bytes", p.memory_bytes()}};
}

}  // namespace

json jobJson(const v1::Job& job) {
  json document{{"job", job.id()},
                {"client", job.client()},
                {"state", stateName(job.state())},
                {"label", job.spec().label()},
                {"scene", job.spec().scene()},
                {"environment", job.spec().environment()},
                {"priority", job.spec().priority()},
                {"settings", parsed(job.spec().settings_json())},
                {"created_ms", job.created_ms()},
                {"started_ms", job.started_ms() ? json(job.started_ms()) : json(nullptr)},
                {"finished_ms", job.finished_ms() ? json(job.finished_ms()) : json(nullptr)},
                {"attempts", job.attempts()},
                {"waiting_for", job.waiting_for()},
                {"progress", progressJson(job.progress())},
                {"warnings", json::array()},
                {"error", nullptr},
                {"result", nullptr}};
  for (const auto& warning : job.warnings()) document["warnings"].push_back({{"place", warning.place()}, {"message", warning.message()}});
  if (job.state() == v1::JOB_STATE_FAILED)
    document["error"] = {{"id", job.error().id()}, {"message", job.error().message()}, {"stderr_tail", job.error().stderr_tail()}};
  if (job.state() == v1::JOB_STATE_SUCCEEDED)
    document["result"] = {{"sha256", job.result().sha256()},
                          {"bytes", job.result().size()},
                          {"from_cache", job.result().from_cache()},
                          {"preview", !job.result().preview_sha256().empty()},
                          {"report", parsed(job.result().report_json())}};
  return document;
}

}  // namespace lightwell::server
