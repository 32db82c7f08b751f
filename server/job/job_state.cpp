#include "server/job/job_state.h"

#include <algorithm>
#include <iterator>

namespace lightwell::server {
namespace {

constexpr struct {
  v1::JobState from, to;
} kTransitions[] = {
    {v1::JOB_STATE_QUEUED, v1::JOB_STATE_RUNNING},     // a worker was started for it
    {v1::JOB_STATE_QUEUED, v1::JOB_STATE_SUCCEEDED},   // the same request was answered in the meantime
    {v1::JOB_STATE_QUEUED, v1::JOB_STATE_FAILED},      // it can never start: its estimated memory is over its limit
    {v1::JOB_STATE_QUEUED, v1::JOB_STATE_CANCELLED},
    {v1::JOB_STATE_RUNNING, v1::JOB_STATE_SUCCEEDED},
    {v1::JOB_STATE_RUNNING, v1::JOB_STATE_FAILED},     // the input, a limit, a crash
    {v1::JOB_STATE_RUNNING, v1::JOB_STATE_CANCELLED},
    {v1::JOB_STATE_RUNNING, v1::JOB_STATE_QUEUED},     // the daemon ended, or something outside killed the worker
};

}  // namespace

bool isFinal(v1::JobState state) { return state >= v1::JOB_STATE_SUCCEEDED; }

bool isTransition(v1::JobState from, v1::JobState to) {
  return std::any_of(std::begin(kTransitions), std::end(kTransitions), [&](const auto& t) { return t.from == from && t.to == to; });
}

const char* name(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_QUEUED: return "queued";
    case v1::JOB_STATE_RUNNING: return "running";
    case v1::JOB_STATE_SUCCEEDED: return "succeeded";
    case v1::JOB_STATE_FAILED: return "failed";
    case v1::JOB_STATE_CANCELLED: return "cancelled";
    default: return "unknown";
  }
}

}  // namespace lightwell::server
