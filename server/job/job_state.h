// The states of a job, and the only ways between them. docs/service.md draws the same table.
#pragma once
#include "lightwell/v1/service.pb.h"

namespace lightwell::server {

/// succeeded, failed and cancelled are final.
bool isFinal(v1::JobState state);
/// Whether a job may go from one state to another.
bool isTransition(v1::JobState from, v1::JobState to);
/// "queued", "running", …
const char* name(v1::JobState state);

}  // namespace lightwell::server
