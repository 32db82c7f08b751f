#include "precompute/scene/gltf/jpeg_tables.h"

#include <algorithm>
#include <numeric>
#include <optional>

namespace lightwell::scene::gltf {
namespace {

// Markers of ITU-T T.81, table B.1.
constexpr uint8_t kDefineHuffmanTables = 0xC4;
constexpr uint8_t kFirstRestart = 0xD0, kLastRestart = 0xD7;
constexpr uint8_t kStartOfImage = 0xD8, kEndOfImage = 0xD9, kStartOfScan = 0xDA;

constexpr size_t kCodeLengths = 16, kMostSymbols = 256;

bool isRestart(uint8_t marker) { return marker >= kFirstRestart && marker <= kLastRestart; }

/// Whether a segment of parameters follows the marker, its length first.
bool hasParameters(uint8_t marker) { return marker >= 0xC0 && !isRestart(marker) && marker != kStartOfImage && marker != kEndOfImage; }

/// The next marker at or after @p at, which then is the place behind it. Coded data may lie before it: FF 00 and restarts belong to that.
std::optional<uint8_t> nextMarker(std::span<const uint8_t> bytes, size_t& at, bool in_scan) {
  while (at + 1 < bytes.size()) {
    if (bytes[at++] != 0xFF) continue;
    while (at < bytes.size() && bytes[at] == 0xFF) ++at;
    if (at == bytes.size()) break;
    const uint8_t marker = bytes[at++];
    if (!in_scan || (marker != 0 && !isRestart(marker))) return marker;
  }
  return std::nullopt;
}

/// @param rest    the file behind the segment's length: a table that claims more than its segment has is read from what follows, and zeros behind the end
/// @param length  bytes of the segment's tables
bool tablesFit(std::span<const uint8_t> rest, size_t length) {
  for (size_t at = 0; at < length && at < rest.size();) {
    const auto counts = rest.subspan(at + 1, std::min(kCodeLengths, rest.size() - at - 1));
    const auto symbols = std::accumulate(counts.begin(), counts.end(), size_t{0});
    if (symbols > kMostSymbols) return false;
    at += 1 + kCodeLengths + symbols;
  }
  return true;
}

}  // namespace

bool jpegTablesFit(std::span<const uint8_t> bytes) {
  size_t at = 2;
  bool in_scan = false;
  while (const auto marker = nextMarker(bytes, at, in_scan)) {
    if (!hasParameters(*marker) || bytes.size() - at < 2) return true;
    const size_t length = size_t(bytes[at]) << 8 | bytes[at + 1];
    if (length < 2) return true;
    if (*marker == kDefineHuffmanTables && !tablesFit(bytes.subspan(at + 2), length - 2)) return false;
    if (bytes.size() - at < length) return true;
    at += length;
    in_scan = *marker == kStartOfScan;
  }
  return true;
}

}  // namespace lightwell::scene::gltf
