// OpenEXR files as rows of radiance.
#pragma once
#include "precompute/transport/environment/environment_map.h"

namespace lightwell::transport {

/// See openRowSource. Throws InputError.
std::unique_ptr<RowSource> openOpenExrRows(const std::filesystem::path& file, Diagnostics& diagnostics);

}  // namespace lightwell::transport
