// Files that appear whole or not at all.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>

namespace lightwell::format {

/// Replaces `file` by the concatenation of `pieces`: written under no name (or, where the file system cannot, a temporary one in the same
/// folder), synced, then renamed into place. After a failure or a kill the old file is untouched and, but for an instant around the rename,
/// no temporary is left (where nameless files are supported; else a kill may leave one, a failure never does).
/// Throws std::runtime_error naming the file and the reason; refuses to replace what is not a regular file.
void writeFileAtomically(const std::filesystem::path& file, std::span<const std::span<const uint8_t>> pieces);
inline void writeFileAtomically(const std::filesystem::path& file, std::span<const uint8_t> bytes) {
  writeFileAtomically(file, std::span(&bytes, 1));
}

}  // namespace lightwell::format
