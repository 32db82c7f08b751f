// Bytes from outside: files that stay inside the scene's folder, and data URIs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "precompute/scene/file_table.h"
#include "precompute/scene/json_value.h"

namespace lightwell::scene::gltf {

/// The whole of a regular file of at most `max_bytes`; with a `table`, `file` is a name in it. Throws InputError naming it.
std::vector<uint8_t> readFile(const std::filesystem::path& file, uint64_t max_bytes, const FileTable* table = nullptr);

/// The bytes behind a `uri` member: a base64 or percent-encoded data URI, or a file in `folder` or below it. URIs with a scheme, absolute
/// paths and paths that leave the folder, through `..` or a symbolic link, are InputErrors at `uri`. With a `table` only its files exist.
std::vector<uint8_t> readUri(const std::filesystem::path& folder, const JsonValue& uri, uint64_t max_bytes,
                             const FileTable* table = nullptr);

/// The file that `uri` names, relative to the scene's folder: percent-decoded and in normal form. Empty for data URIs, URIs with a
/// scheme, absolute paths and paths that leave the folder.
std::string relativeName(std::string_view uri);

}  // namespace lightwell::scene::gltf
