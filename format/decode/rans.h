// The codec RANS: static entropy coding of bytes whose sizes tell of the sizes beside them. docs/format.md, section 8.
//
// Range asymmetric numeral systems (Duda: "Asymmetric numeral systems: entropy coding combining speed of Huffman coding with compression rate of arithmetic coding").
// Four parts of the data have a state each: one's look-ups wait for memory while the others' compute.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>

namespace lightwell::format::rans {

constexpr uint32_t kScaleBits = 12, kScale = 1u << kScaleBits;  // frequencies of a context add up to this
constexpr uint32_t kLeastState = 1u << 16;
constexpr size_t kParts = 4, kWindow = 16, kContexts = 23, kSymbols = 256;
constexpr size_t kTableBytes = kContexts * kSymbols * 2;  // as planes of U16

/// How large a byte is, read as two's complement: 0 to 128.
inline uint32_t sizeOf(uint8_t value) { return value < 128 ? value : 256u - value; }
/// The context of a byte before which the sizes of the window add up to `sum`: half octaves.
inline uint32_t contextOf(uint32_t sum) {
  if (sum < 2) return sum;
  const uint32_t octave = uint32_t(std::bit_width(sum)) - 1;
  return 2 * octave + (sum >> (octave - 1) & 1);
}
/// Where part `part` of `count` bytes begins; `part` = kParts: the end.
inline size_t partBegin(size_t count, size_t part) {
  const size_t each = (count + kParts - 1) / kParts, begin = each * part;
  return begin < count ? begin : count;
}

/// One number for each context and each remainder of the state: symbol, its frequency less 1, the remainder's place in it.
constexpr size_t kSlots = kContexts * kScale;

/// Fills `slots`, [kSlots], from `planes`, [kTableBytes]. `used`: receives a bit for each context that has a table. False where frequencies do not add up.
bool makeSlots(const uint8_t* planes, uint32_t* slots, uint32_t& used);
/// Decodes `count` bytes from `stored`, four sizes and streams, which must be used up exactly. False where they are damaged.
bool decode(const uint8_t* stored, size_t stored_bytes, const uint32_t* slots, uint32_t used, uint8_t* out, size_t count);

}  // namespace lightwell::format::rans
