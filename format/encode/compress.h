// The encoding side of the chunk codecs.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "format/decode/layout.h"

namespace lightwell::format {

struct Encoded {
  Codec codec = Codec::raw;
  std::vector<uint8_t> stored;
};

/// `data`: elements in little-endian order. The codec is the one that is smallest at zstd level 3 (so that it does not depend on the level;
/// on equal sizes the simpler one), then compressed at `zstd_level`. Deterministic for one version of zstd.
Encoded encodeSmallest(ElementType element, std::span<const uint8_t> data, int zstd_level);

/// With a given codec, for tests and tools. Throws std::invalid_argument when the codec may not store such elements.
std::vector<uint8_t> encodeWith(Codec codec, ElementType element, std::span<const uint8_t> data, int zstd_level);

}  // namespace lightwell::format
