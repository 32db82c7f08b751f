// Encodes the codec RANS; see format/decode/rans.h.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace lightwell::format::rans {

/// A coding of `data`, not empty: what makeSlots() and decode() take.
struct Encoded {
  std::vector<uint8_t> planes;   // kTableBytes
  std::vector<uint8_t> streams;  // their sizes and they
};
Encoded encode(std::span<const uint8_t> data);

}  // namespace lightwell::format::rans
