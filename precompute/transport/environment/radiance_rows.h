// Radiance pictures (.hdr, .pic): G. Ward, "Real Pixels" (Graphics Gems II), and the file format page of the Radiance manual.
#pragma once
#include "precompute/transport/environment/environment_map.h"

namespace lightwell::transport {

/// See openRowSource. The header is read here, pixels when rows are visited. Throws InputError.
std::unique_ptr<RowSource> openRadianceRows(const std::filesystem::path& file, Diagnostics& diagnostics);

}  // namespace lightwell::transport
