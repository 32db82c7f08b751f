// The fixed numbers of the container, shared by writer, reader and runtime. docs/format.md explains each.
#pragma once
#include <cstddef>
#include <cstdint>

namespace lightwell::format {

/// 0x89 catches 7-bit transfers, CR LF and LF catch newline translation, 0x1a stops a terminal listing (after PNG).
inline constexpr uint8_t kMagic[8] = {0x89, 'L', 'W', 'C', '\r', '\n', 0x1a, '\n'};
inline constexpr uint16_t kVersionMajor = 1, kVersionMinor = 0;
inline constexpr size_t kHeaderBytes = 64;
inline constexpr size_t kAlignment = 16;  // of the directory and of every chunk; the padding is zero

// File header, little-endian:
//   0  u8[8]  magic
//   8  u16    version_major     a reader rejects a greater one
//  10  u16    version_minor     a reader accepts any
//  12  u32    reserved, zero    a reader rejects other values
//  16  u64    file_bytes        the whole file
//  24  u64    directory_offset  64 in version 1
//  32  u64    directory_bytes
//  40  u64    directory_checksum  XXH3-64 of the directory's bytes
//  48  u64    reserved, zero
//  56  u64    header_checksum   XXH3-64 of bytes 0 to 55

// Same values as lightwell.v1.ElementType and lightwell.v1.Codec (a test compares them).
enum class ElementType : uint8_t { bytes = 1, u8, i8, u16, i16, u32, f16, f32, rgb9e5 };
enum class Codec : uint8_t { raw = 1, zstd, zstd_planes, zstd_delta_planes };

constexpr size_t elementBytes(ElementType type) {
  switch (type) {
    case ElementType::bytes: case ElementType::u8: case ElementType::i8: return 1;
    case ElementType::u16: case ElementType::i16: case ElementType::f16: return 2;
    case ElementType::u32: case ElementType::f32: case ElementType::rgb9e5: return 4;
  }
  return 0;
}

}  // namespace lightwell::format
