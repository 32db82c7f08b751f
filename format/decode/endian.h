// Little-endian numbers in byte strings, whatever the host is.
#pragma once
#include <cstddef>
#include <cstdint>

namespace lightwell::format {

template <class Unsigned>
constexpr Unsigned loadLittle(const uint8_t* bytes) {
  Unsigned value = 0;
  for (size_t i = 0; i < sizeof(Unsigned); ++i) value = Unsigned(value | Unsigned(bytes[i]) << (8 * i));
  return value;
}
template <class Unsigned>
constexpr void storeLittle(uint8_t* bytes, Unsigned value) {
  for (size_t i = 0; i < sizeof(Unsigned); ++i) bytes[i] = uint8_t(value >> (8 * i));
}

}  // namespace lightwell::format
