// Failures as gRPC statuses: one table.
#pragma once
#include <grpcpp/support/status.h>

#include <functional>

#include "server/failure.h"

namespace lightwell::server {

grpc::StatusCode statusCode(FailureId id);
grpc::Status statusOf(const Failure& failure);
/// Runs `body`; what it throws becomes a status. Nothing gets past it.
grpc::Status guarded(const std::function<void()>& body);

}  // namespace lightwell::server
