// Containers that no Writer would make: any directory, any stored bytes, with checksums that are right unless a test spoils them too.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "format/decode/layout.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {

struct Forge {
  static constexpr size_t kDirectoryBytes = 1024;  // filled up with an unknown field, so that edits move nothing

  v1::Directory directory;
  std::vector<std::string> stored;  // one per chunk of the directory

  v1::Section& section(std::string_view type, uint32_t version = 1, bool required = false);
  /// The chunk at the next place, with right offset, size and checksum; edit what it returns afterwards.
  v1::Chunk& chunk(std::string_view section, std::string_view name, ElementType element, std::vector<uint64_t> shape, Codec codec,
                   std::string stored_bytes);
  std::vector<uint8_t> build() const;
};

/// Header and `directory` (any bytes), then `rest`, as a file with right sizes and checksums.
std::vector<uint8_t> assemble(std::string_view directory, std::string_view rest);
/// Rewrites the checksums of header and directory after edits.
void fixChecksums(std::vector<uint8_t>& file);

}  // namespace lightwell::format
