// The worker process: bakes one job and ends. The protocol is schemas/lightwell/v1/service_worker.proto.
#pragma once
#include <functional>

#include "lightwell/v1/service_worker.pb.h"

namespace lightwell::server {

/// Descriptor of the worker's events.
inline constexpr int kEventDescriptor = 3;

/// A worker's whole main(): reads the request from standard input, reports on kEventDescriptor. Ends at once when the daemon does, within
/// half a second on SIGTERM. `before`, for tests, is called with the request before the work begins. Returns the exit code.
int runWorker(const std::function<void(const v1::WorkerRequest&)>& before = {});

}  // namespace lightwell::server
