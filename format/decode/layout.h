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
inline constexpr size_t kMaxRank = 4;     // numbers in a chunk's shape
inline constexpr size_t kMaxNameBytes = 63;         // of section types and chunk names: [a-z0-9_]+
inline constexpr uint64_t kMaxExpansion = 32768;    // raw_bytes / stored_bytes: what a zstd RLE block can reach at most

// File header, little-endian:
//   0  u8[8]  magic
//   8  u16    version_major     a reader rejects a greater one, and zero
//  10  u16    version_minor     a reader accepts any
//  12  u32    reserved, zero    a reader rejects other values
//  16  u64    file_bytes        the whole file
//  24  u64    directory_offset  64 in version 1
//  32  u64    directory_bytes
//  40  u64    directory_checksum  XXH3-64 of the directory's bytes
//  48  u64    reserved, zero
//  56  u64    header_checksum   XXH3-64 of bytes 0 to 55
// Then the directory and the chunks in the order of the directory, each at the next multiple of 16. The file ends with the last of them.

// Same values as lightwell.v1.ElementType and lightwell.v1.Codec (a test compares them).
enum class ElementType : uint8_t { bytes = 1, u8, i8, u16, i16, u32, f16, f32, rgb9e5 };
enum class Codec : uint8_t { raw = 1, zstd, zstd_planes, zstd_delta_planes, rans };

/// Bytes of one element; 0 for a value that this version does not know.
constexpr size_t elementBytes(ElementType type) {
  switch (type) {
    case ElementType::bytes: case ElementType::u8: case ElementType::i8: return 1;
    case ElementType::u16: case ElementType::i16: case ElementType::f16: return 2;
    case ElementType::u32: case ElementType::f32: case ElementType::rgb9e5: return 4;
  }
  return 0;
}
constexpr bool isInteger(ElementType type) { return type >= ElementType::u8 && type <= ElementType::u32; }
/// Which codec may store which element: planes need more than one byte, differences need integers, RANS needs single bytes.
constexpr bool codecAllowed(Codec codec, ElementType type) {
  switch (codec) {
    case Codec::raw: case Codec::zstd: return elementBytes(type) != 0;
    case Codec::zstd_planes: return elementBytes(type) > 1;
    case Codec::zstd_delta_planes: return isInteger(type);
    case Codec::rans: return elementBytes(type) == 1;
  }
  return false;
}
constexpr uint64_t alignUp(uint64_t offset) { return (offset + (kAlignment - 1)) & ~uint64_t(kAlignment - 1); }

/// The sections that this version of the code knows, each up to its version.
struct KnownSection {
  const char* type;
  uint32_t version;
};
inline constexpr KnownSection kKnownSections[] = {{"meta", 1}, {"scene", 1}, {"geometry", 1}, {"atlas", 1}, {"prm", 1},
                                                 {"environment", 1}, {"radiosity", 1}, {"probes", 1}, {"lightmap", 1}, {"vpl", 1}, {"points", 1}, {"prm_probes", 1}};

}  // namespace lightwell::format
