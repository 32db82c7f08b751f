// A job as JSON: for the status page and for `lightwell jobs|watch --json`.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "lightwell/v1/service.pb.h"

namespace lightwell::server {

/// schemas/job.schema.json.
nlohmann::json jobJson(const v1::Job& job);

}  // namespace lightwell::server
