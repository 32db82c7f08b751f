// Requests that cannot be answered as asked. Every layer throws these; the RPC layer turns them into statuses by one table.
#pragma once
#include <stdexcept>
#include <string>

namespace lightwell::server {

enum class FailureId {
  invalid_request,    // a field is missing, malformed or out of range
  invalid_settings,   // settings that the baker refuses
  missing_file,       // a file of the job was never uploaded, or is not there any more
  job_not_found,
  job_finished,       // too late for that
  job_unfinished,     // too early for that
  no_result,          // the job failed or was cancelled
  unauthenticated,    // no token, or a wrong one
  hash_mismatch,      // an upload is not what its name says
  upload_too_large,
  upload_in_use,      // another stream sends the same file
  upload_stalled,     // nothing came for too long
  offset_mismatch,    // the server has less than the upload leaves out
  too_many_jobs,      // of this client
  too_many_streams,
  quota_exceeded,     // of this client's uploads
  store_full,         // --max-store-bytes, and nothing can be let go
  disk_full,
  shutting_down,
  internal,
};

/// The stable id: "job_not_found".
const char* name(FailureId id);

class Failure : public std::runtime_error {
 public:
  Failure(FailureId id, const std::string& message) : std::runtime_error(message), id(id) {}
  FailureId id;
};

}  // namespace lightwell::server
