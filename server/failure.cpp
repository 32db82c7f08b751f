#include "server/failure.h"

namespace lightwell::server {

const char* name(FailureId id) {
  switch (id) {
    case FailureId::invalid_request: return "invalid_request";
    case FailureId::invalid_settings: return "invalid_settings";
    case FailureId::missing_file: return "missing_file";
    case FailureId::job_not_found: return "job_not_found";
    case FailureId::job_finished: return "job_finished";
    case FailureId::job_unfinished: return "job_unfinished";
    case FailureId::no_result: return "no_result";
    case FailureId::unauthenticated: return "unauthenticated";
    case FailureId::hash_mismatch: return "hash_mismatch";
    case FailureId::upload_too_large: return "upload_too_large";
    case FailureId::upload_in_use: return "upload_in_use";
    case FailureId::upload_stalled: return "upload_stalled";
    case FailureId::offset_mismatch: return "offset_mismatch";
    case FailureId::too_many_jobs: return "too_many_jobs";
    case FailureId::too_many_streams: return "too_many_streams";
    case FailureId::quota_exceeded: return "quota_exceeded";
    case FailureId::store_full: return "store_full";
    case FailureId::disk_full: return "disk_full";
    case FailureId::shutting_down: return "shutting_down";
    case FailureId::internal: return "internal";
  }
  return "internal";
}

}  // namespace lightwell::server
