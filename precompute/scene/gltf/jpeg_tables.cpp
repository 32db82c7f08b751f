#include "precompute/scene/gltf/jpeg_tables.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <numeric>
#include <optional>

namespace lightwell::scene::gltf {
namespace {

// Markers of ITU-T T.81, table B.1.
constexpr uint8_t kBaselineFrame = 0xC0, kExtendedFrame = 0xC1, kProgressiveFrame = 0xC2;
constexpr uint8_t kDefineHuffmanTables = 0xC4, kDefineQuantisationTables = 0xDB;
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

/// Tables that the segments so far have defined, and the frame that a scan's components belong to.
class JpegTables {
 public:
  /// Reads a segment of parameters and says what is wrong with it.
  /// @param rest    the file behind the segment's length: a Huffman table that claims more than its segment has is read from what follows, and zeros behind the end
  /// @param length  bytes of the segment's parameters
  std::string read(uint8_t marker, std::span<const uint8_t> rest, size_t length) {
    const auto parameters = rest.first(std::min(length, rest.size()));
    switch (marker) {
      case kDefineHuffmanTables: return defineHuffman(rest, length);
      case kDefineQuantisationTables: defineQuantisation(parameters); return {};
      case kBaselineFrame:
      case kExtendedFrame:
      case kProgressiveFrame: beginFrame(marker == kProgressiveFrame, parameters); return {};
      case kStartOfScan: return scan(parameters);
      default: return {};
    }
  }

 private:
  std::string defineHuffman(std::span<const uint8_t> rest, size_t length) {
    for (size_t at = 0; at < length && at < rest.size();) {
      const auto counts = rest.subspan(at + 1, std::min(kCodeLengths, rest.size() - at - 1));
      const auto symbols = std::accumulate(counts.begin(), counts.end(), size_t{0});
      if (symbols > kMostSymbols) return "a Huffman table has more than 256 symbols";
      auto& defined = (rest[at] >> 4) == 0 ? dc_huffman_ : ac_huffman_;
      defined.set(rest[at] & 15);
      at += 1 + kCodeLengths + symbols;
    }
    return {};
  }

  void defineQuantisation(std::span<const uint8_t> parameters) {
    for (size_t at = 0; at < parameters.size(); at += 1 + 64 * (parameters[at] >> 4 ? 2 : 1)) quantisation_.set(parameters[at] & 15);
  }

  void beginFrame(bool progressive, std::span<const uint8_t> parameters) {
    progressive_ = progressive;
    for (size_t at = 6; at + 3 <= parameters.size(); at += 3) quantisation_of_component_[parameters[at]] = parameters[at + 2];
  }

  std::string scan(std::span<const uint8_t> parameters) const {
    if (parameters.empty()) return {};
    const size_t components = parameters[0], selection = 1 + 2 * components;
    if (parameters.size() < selection + 3) return {};
    // A scan of a progressive frame holds either the first coefficient or others of each block, and of the first no code is needed for a later bit.
    const bool first_coefficient = parameters[selection] == 0, later_bit = parameters[selection + 2] >> 4 != 0;
    const bool needs_dc = !progressive_ || (first_coefficient && !later_bit), needs_ac = !progressive_ || !first_coefficient;
    for (size_t i = 0; i < components; ++i) {
      const uint8_t component = parameters[1 + 2 * i], huffman = parameters[2 + 2 * i];
      if ((needs_dc && !dc_huffman_[huffman >> 4]) || (needs_ac && !ac_huffman_[huffman & 15])) return "a scan names a Huffman table that is not defined before it";
      if (!quantisation_[quantisation_of_component_[component] & 15]) return "a scan names a quantisation table that is not defined before it";
    }
    return {};
  }

  std::bitset<16> dc_huffman_, ac_huffman_, quantisation_;
  std::array<uint8_t, 256> quantisation_of_component_{};
  bool progressive_ = false;
};

}  // namespace

std::string jpegTableDefect(std::span<const uint8_t> bytes) {
  JpegTables tables;
  size_t at = 2;
  bool in_scan = false;
  while (const auto marker = nextMarker(bytes, at, in_scan)) {
    if (!hasParameters(*marker) || bytes.size() - at < 2) break;
    const size_t length = size_t(bytes[at]) << 8 | bytes[at + 1];
    if (length < 2) break;
    if (std::string defect = tables.read(*marker, bytes.subspan(at + 2), length - 2); !defect.empty()) return defect;
    if (bytes.size() - at < length) break;
    at += length;
    in_scan = *marker == kStartOfScan;
  }
  return {};
}

}  // namespace lightwell::scene::gltf
