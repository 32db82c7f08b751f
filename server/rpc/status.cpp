#include "server/rpc/status.h"

#include "lightwell/v1/service.pb.h"
#include "server/store/sqlite.h"

namespace lightwell::server {

grpc::StatusCode statusCode(FailureId id) {
  switch (id) {
    case FailureId::invalid_request:
    case FailureId::invalid_settings:
    case FailureId::hash_mismatch: return grpc::StatusCode::INVALID_ARGUMENT;
    case FailureId::offset_mismatch: return grpc::StatusCode::OUT_OF_RANGE;
    case FailureId::job_not_found: return grpc::StatusCode::NOT_FOUND;
    case FailureId::missing_file:
    case FailureId::job_finished:
    case FailureId::job_unfinished:
    case FailureId::no_result: return grpc::StatusCode::FAILED_PRECONDITION;
    case FailureId::unauthenticated: return grpc::StatusCode::UNAUTHENTICATED;
    case FailureId::upload_in_use: return grpc::StatusCode::ABORTED;
    case FailureId::upload_stalled: return grpc::StatusCode::DEADLINE_EXCEEDED;
    case FailureId::upload_too_large:
    case FailureId::too_many_jobs:
    case FailureId::too_many_streams:
    case FailureId::quota_exceeded:
    case FailureId::store_full:
    case FailureId::disk_full: return grpc::StatusCode::RESOURCE_EXHAUSTED;
    case FailureId::shutting_down: return grpc::StatusCode::UNAVAILABLE;
    case FailureId::internal: return grpc::StatusCode::INTERNAL;
  }
  return grpc::StatusCode::INTERNAL;
}

grpc::Status statusOf(const Failure& failure) {
  v1::ErrorDetail detail;
  detail.set_id(name(failure.id));
  detail.set_message(failure.what());
  return {statusCode(failure.id), failure.what(), detail.SerializeAsString()};
}

grpc::Status guarded(const std::function<void()>& body) {
  try {
    body();
    return grpc::Status::OK;
  } catch (const Failure& failure) {
    return statusOf(failure);
  } catch (const StoreError& error) {
    return statusOf(Failure(error.diskFull() ? FailureId::disk_full : FailureId::internal, error.what()));
  } catch (const std::exception& error) {
    return statusOf(Failure(FailureId::internal, error.what()));
  }
}

}  // namespace lightwell::server
