// Reading a container without trusting it. No exceptions, no RTTI, no protobuf, no globals: this half is linked into the runtime.
//
// open() reads and checks header and directory; decode() reads one chunk, checks its checksum and padding, and unpacks it into memory of
// the caller, whose size is ChunkInfo::raw_bytes. Any bytes may be fed in: the answer is a Fault, never a crash, a hang or an allocation
// beyond the limits. A View is immutable once open; decode() may run on several threads.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "format/decode/layout.h"
#include "format/decode/source.h"
#include "format/decode/status.h"

namespace lightwell::format {

struct SectionInfo {
  std::string_view type;
  uint32_t version = 0;   // ≥ 1
  bool required = false;
  bool known = false;     // of a type and version in kKnownSections
};

/// One chunk as the directory describes it, already checked to lie inside the file and to be of possible size.
struct ChunkInfo {
  std::string_view section, name;  // live as long as the View
  uint32_t section_index = 0;      // into View::sections()
  ElementType element{};
  Codec codec{};
  bool decodable = false;          // false: codec or element type of a later version; raw_bytes is then 0
  uint32_t rank = 0;
  uint64_t shape[kMaxRank] = {};   // [0, rank)
  uint64_t elements = 1;           // product of the shape
  uint64_t raw_bytes = 0;          // decoded
  uint64_t offset = 0, stored_bytes = 0;  // in the file
  uint64_t checksum = 0;           // XXH3-64 of the stored bytes
};

struct OpenOptions {
  Limits limits;
  Allocator allocator;
};

class View {
 public:
  View() = default;
  ~View() { close(); }
  View(View&& other) noexcept { swap(other); }
  View& operator=(View&& other) noexcept {
    swap(other);
    return *this;
  }

  /// Reads header and directory. Closes what was open before. `source` (and what it points to) must stay valid until close().
  /// Fails with any Status from io_error to out_of_memory except bad_section; an unknown required section is too_new.
  Fault open(const Source& source, const OpenOptions& options = {});
  void close();
  bool isOpen() const { return directory_ != nullptr; }

  uint16_t versionMinor() const { return version_minor_; }
  uint64_t fileBytes() const { return source_.bytes; }
  uint64_t directoryBytes() const { return directory_bytes_; }
  uint64_t directoryChecksum() const { return directory_checksum_; }  // names the content: equal files have equal ones
  /// In the order of the directory. Live until close().
  std::span<const SectionInfo> sections() const { return {sections_, section_count_}; }
  /// In the order of the file. Live until close().
  std::span<const ChunkInfo> chunks() const { return {chunks_, chunk_count_}; }
  /// Null when the file has none of that name.
  const SectionInfo* findSection(std::string_view type) const;
  const ChunkInfo* findChunk(std::string_view section, std::string_view name) const;

  /// Decodes `chunk` (one of chunks()) into `destination`; `bytes` must equal chunk.raw_bytes (else invalid_argument). Multi-byte elements
  /// arrive in the host's byte order. Fails with io_error, bad_checksum, bad_chunk, trailing_bytes (padding), too_new or out_of_memory;
  /// the destination's content is then unspecified. Temporary memory: at most stored_bytes + raw_bytes + 160 kB, from the allocator.
  Fault decode(const ChunkInfo& chunk, void* destination, size_t bytes) const;
  /// Checks the stored bytes and the padding after them without decoding. Temporary memory: 64 KiB.
  Fault checkStored(const ChunkInfo& chunk) const;

 private:
  void swap(View& other) noexcept;
  Fault parseHeader();
  Fault readDirectory();
  Fault parseDirectory();
  Fault placeChunks();
  Fault checkPadding(const ChunkInfo& chunk) const;

  Source source_;
  Limits limits_;
  Allocator allocator_;
  uint8_t* directory_ = nullptr;  // its bytes; every string_view points here
  size_t directory_bytes_ = 0;
  uint64_t directory_checksum_ = 0;
  uint16_t version_minor_ = 0;
  SectionInfo* sections_ = nullptr;
  ChunkInfo* chunks_ = nullptr;
  uint32_t* chunk_order_ = nullptr;  // indices of chunks_, sorted by (section, name)
  size_t section_count_ = 0, chunk_count_ = 0;
};

}  // namespace lightwell::format
