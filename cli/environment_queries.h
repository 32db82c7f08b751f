// Q.json: what `lightwell environment` asks a sky.
//
//   {"queries": [{"normal": [x, y, z]}, {"mirror": [x, y, z], "shininess": n}]}     n from 1 to 1e5; unknown keys are errors
#pragma once
#include <filesystem>
#include <vector>

#include "precompute/transport/environment/evaluate_environment.h"

namespace lightwell::cli {

/// Directions come back as unit vectors. Throws InputError naming the place; at most 2^20 queries.
std::vector<transport::EnvironmentQuery> readQueries(const std::filesystem::path& file);

}  // namespace lightwell::cli
