// What OpenEXR's C++ library takes on trust: it allocates what an attribute of the header claims to be long, before it reads any of it.
#pragma once
#include <filesystem>

namespace lightwell {

/// Has OpenEXR's C library, which compares every size with the file's, read the headers. Throws InputError at whatever it complains of, so that headers never take more memory than the file
/// has bytes. To be called before the C++ library opens `file`.
void checkExrHeaders(const std::filesystem::path& file);

}  // namespace lightwell
