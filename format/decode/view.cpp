#include "format/decode/view.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "format/decode/checksum.h"
#include "format/decode/endian.h"
#include "format/decode/wire.h"

namespace lightwell::format {
namespace {

bool readSource(const Source& source, uint64_t offset, void* destination, size_t bytes) {
  if (offset > source.bytes || bytes > source.bytes - offset) return false;
  if (bytes == 0) return true;
  if (source.memory) {
    std::memcpy(destination, source.memory + offset, bytes);
    return true;
  }
  return source.read && source.read(source.user, offset, destination, bytes);
}

/// Names are safe to print and to use as file names.
bool validName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxNameBytes && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

bool knows(std::string_view type, uint32_t version) {
  return std::any_of(std::begin(kKnownSections), std::end(kKnownSections),
                     [&](const KnownSection& known) { return type == known.type && version <= known.version; });
}

bool parseSection(std::string_view message, SectionInfo& section) {
  WireReader reader(message);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(section.type); break;
      case 2: reader.read(section.version); break;
      case 3: reader.read(section.required); break;
    }
  section.known = knows(section.type, section.version);
  return reader.ok() && validName(section.type) && section.version >= 1;
}

/// The message alone; sizes are judged by `sizeChunk`.
bool parseChunk(std::string_view message, ChunkInfo& chunk) {
  uint32_t element = 0, codec = 0;
  WireReader reader(message);
  while (reader.next()) switch (reader.field()) {
      case 1: reader.read(chunk.section); break;
      case 2: reader.read(chunk.name); break;
      case 3: reader.read(element); break;
      case 4: reader.append(chunk.shape, kMaxRank, chunk.rank); break;
      case 5: reader.read(codec); break;
      case 6: reader.read(chunk.offset); break;
      case 7: reader.read(chunk.stored_bytes); break;
      case 8: reader.readFixed64(chunk.checksum); break;
    }
  if (!reader.ok() || !validName(chunk.section) || !validName(chunk.name) || element == 0 || codec == 0) return false;
  chunk.element = ElementType(std::min(element, 255u));
  chunk.codec = Codec(std::min(codec, 255u));
  chunk.decodable = elementBytes(chunk.element) != 0 && chunk.codec <= Codec::rans;
  return !chunk.decodable || codecAllowed(chunk.codec, chunk.element);
}

bool multiply(uint64_t a, uint64_t b, uint64_t& product) { return !__builtin_mul_overflow(a, b, &product); }

/// Fills elements and raw_bytes. Status::ok, or what is wrong with them.
Status sizeChunk(ChunkInfo& chunk) {
  chunk.elements = 1;
  for (uint32_t i = 0; i < chunk.rank; ++i)
    if (!multiply(chunk.elements, chunk.shape[i], chunk.elements)) return Status::bad_directory;
  if (!chunk.decodable) return Status::ok;
  if (!multiply(chunk.elements, elementBytes(chunk.element), chunk.raw_bytes)) return Status::bad_directory;
  if (chunk.codec == Codec::raw) return chunk.stored_bytes == chunk.raw_bytes ? Status::ok : Status::bad_chunk;
  // An empty chunk is stored raw; and nothing holds more than kMaxExpansion times its own size: no zstd frame can.
  if (chunk.raw_bytes == 0 || (chunk.raw_bytes - 1) / kMaxExpansion >= chunk.stored_bytes) return Status::bad_chunk;
  return Status::ok;
}

struct NameOrder {
  const ChunkInfo* chunks;
  std::pair<std::string_view, std::string_view> key(uint32_t i) const { return {chunks[i].section, chunks[i].name}; }
  bool operator()(uint32_t a, uint32_t b) const { return key(a) < key(b); }
};

}  // namespace

void View::swap(View& other) noexcept {
  std::swap(source_, other.source_);
  std::swap(limits_, other.limits_);
  std::swap(allocator_, other.allocator_);
  std::swap(directory_, other.directory_);
  std::swap(directory_bytes_, other.directory_bytes_);
  std::swap(directory_checksum_, other.directory_checksum_);
  std::swap(version_minor_, other.version_minor_);
  std::swap(sections_, other.sections_);
  std::swap(chunks_, other.chunks_);
  std::swap(chunk_order_, other.chunk_order_);
  std::swap(section_count_, other.section_count_);
  std::swap(chunk_count_, other.chunk_count_);
}

void View::close() {
  release(allocator_, chunk_order_);
  release(allocator_, chunks_);
  release(allocator_, sections_);
  release(allocator_, directory_);
  directory_ = nullptr;
  sections_ = nullptr;
  chunks_ = nullptr;
  chunk_order_ = nullptr;
  directory_bytes_ = section_count_ = chunk_count_ = 0;
  directory_checksum_ = 0;
  version_minor_ = 0;
  source_ = {};
}

Fault View::open(const Source& source, const OpenOptions& options) {
  close();
  source_ = source;
  limits_ = options.limits;
  allocator_ = options.allocator;
  Fault fault = parseHeader();
  if (!fault) fault = readDirectory();
  if (!fault) fault = parseDirectory();
  if (!fault) fault = placeChunks();
  if (fault) close();
  return fault;
}

Fault View::parseHeader() {
  if (!source_.read && !source_.memory) return makeFault(Status::invalid_argument, 0, "source without a reader");
  uint8_t header[kHeaderBytes];
  const size_t available = size_t(std::min<uint64_t>(source_.bytes, kHeaderBytes));
  if (!readSource(source_, 0, header, available)) return makeFault(Status::io_error, 0, "header: cannot be read");
  if (std::memcmp(header, kMagic, std::min(available, sizeof(kMagic))) != 0)
    return makeFault(Status::bad_magic, 0, "header: not a Lightwell container");
  if (available < kHeaderBytes)
    return makeFault(Status::truncated, source_.bytes, "header: the file ends after %zu of %zu bytes", available, kHeaderBytes);

  // The version comes before the checksum: a later major version may have another header.
  const uint16_t major = loadLittle<uint16_t>(header + 8);
  if (major > kVersionMajor) return makeFault(Status::too_new, 8, "header: version %u is newer than %u", major, kVersionMajor);
  if (checksum(header, 56) != loadLittle<uint64_t>(header + 56))
    return makeFault(Status::bad_checksum, 56, "header: checksum differs");
  if (major == 0) return makeFault(Status::bad_header, 8, "header: version 0");
  version_minor_ = loadLittle<uint16_t>(header + 10);
  if (loadLittle<uint32_t>(header + 12) != 0) return makeFault(Status::bad_header, 12, "header: reserved bytes are not zero");
  if (loadLittle<uint64_t>(header + 48) != 0) return makeFault(Status::bad_header, 48, "header: reserved bytes are not zero");

  const uint64_t file_bytes = loadLittle<uint64_t>(header + 16), directory_bytes = loadLittle<uint64_t>(header + 32);
  directory_checksum_ = loadLittle<uint64_t>(header + 40);
  if (loadLittle<uint64_t>(header + 24) != kHeaderBytes)
    return makeFault(Status::bad_header, 24, "header: the directory is not at byte 64");
  if (file_bytes < kHeaderBytes || directory_bytes > file_bytes - kHeaderBytes)
    return makeFault(Status::bad_header, 32, "header: the directory reaches past the end of the file");
  if (file_bytes > limits_.file_bytes)
    return makeFault(Status::limit_exceeded, 16, "header: %llu bytes are more than the limit",
                     static_cast<unsigned long long>(file_bytes));
  if (directory_bytes > limits_.directory_bytes)
    return makeFault(Status::limit_exceeded, 32, "header: a directory of %llu bytes is larger than the limit",
                     static_cast<unsigned long long>(directory_bytes));
  if (source_.bytes < file_bytes)
    return makeFault(Status::truncated, source_.bytes, "the file has %llu of %llu bytes", static_cast<unsigned long long>(source_.bytes),
                     static_cast<unsigned long long>(file_bytes));
  if (source_.bytes > file_bytes)
    return makeFault(Status::trailing_bytes, file_bytes, "%llu bytes follow the end of the file",
                     static_cast<unsigned long long>(source_.bytes - file_bytes));
  directory_bytes_ = size_t(directory_bytes);
  return {};
}

Fault View::readDirectory() {
  const uint64_t end = kHeaderBytes + directory_bytes_;
  const size_t padding = size_t(std::min(alignUp(end), source_.bytes) - end);
  directory_ = static_cast<uint8_t*>(allocate(allocator_, directory_bytes_ + kAlignment));
  if (!directory_) return makeFault(Status::out_of_memory, kHeaderBytes, "directory: no memory");
  if (!readSource(source_, kHeaderBytes, directory_, directory_bytes_ + padding))
    return makeFault(Status::io_error, kHeaderBytes, "directory: cannot be read");
  if (checksum(directory_, directory_bytes_) != directory_checksum_)
    return makeFault(Status::bad_checksum, kHeaderBytes, "directory: checksum differs");
  for (size_t i = 0; i < padding; ++i)
    if (directory_[directory_bytes_ + i] != 0) return makeFault(Status::trailing_bytes, end + i, "directory: padding is not zero");
  return {};
}

Fault View::parseDirectory() {
  const auto bad = [](const char* reason) { return makeFault(Status::bad_directory, kHeaderBytes, "directory: %s", reason); };
  size_t section_count = 0, chunk_count = 0;
  WireReader counter(directory_, directory_bytes_);
  while (counter.next()) {
    section_count += counter.field() == 1;
    chunk_count += counter.field() == 2;
  }
  if (!counter.ok()) return bad("not a valid message");
  if (section_count > limits_.sections)
    return makeFault(Status::limit_exceeded, kHeaderBytes, "directory: %zu sections are more than the limit", section_count);
  if (chunk_count > limits_.chunks)
    return makeFault(Status::limit_exceeded, kHeaderBytes, "directory: %zu chunks are more than the limit", chunk_count);

  sections_ = static_cast<SectionInfo*>(allocate(allocator_, (section_count + 1) * sizeof(SectionInfo)));
  chunks_ = static_cast<ChunkInfo*>(allocate(allocator_, (chunk_count + 1) * sizeof(ChunkInfo)));
  chunk_order_ = static_cast<uint32_t*>(allocate(allocator_, (chunk_count + 1) * sizeof(uint32_t)));
  if (!sections_ || !chunks_ || !chunk_order_) return makeFault(Status::out_of_memory, kHeaderBytes, "directory: no memory");

  WireReader reader(directory_, directory_bytes_);
  while (reader.next()) {
    if (reader.field() == 1) {
      SectionInfo& section = *new (&sections_[section_count_]) SectionInfo;
      if (!parseSection(reader.bytes(), section)) return bad("a section is not valid");
      if (findSection(section.type)) return bad("a section occurs twice");
      ++section_count_;
    } else if (reader.field() == 2) {
      ChunkInfo& chunk = *new (&chunks_[chunk_count_]) ChunkInfo;
      if (!parseChunk(reader.bytes(), chunk)) return bad("a chunk is not valid");
      chunk_order_[chunk_count_] = uint32_t(chunk_count_);
      ++chunk_count_;
    }
  }
  if (!reader.ok()) return bad("not a valid message");

  const NameOrder order{chunks_};
  std::sort(chunk_order_, chunk_order_ + chunk_count_, order);
  for (size_t i = 1; i < chunk_count_; ++i)
    if (!order(chunk_order_[i - 1], chunk_order_[i])) return bad("a chunk occurs twice");
  for (size_t i = 0; i < chunk_count_; ++i) {
    const SectionInfo* section = findSection(chunks_[i].section);
    if (!section) return bad("a chunk belongs to no section");
    chunks_[i].section_index = uint32_t(section - sections_);
  }
  for (const SectionInfo& section : sections())
    if (section.required && !section.known)
      return makeFault(Status::too_new, kHeaderBytes, "directory: the file requires section %.*s version %u", int(section.type.size()),
                       section.type.data(), section.version);
  return {};
}

Fault View::placeChunks() {
  uint64_t end = kHeaderBytes + directory_bytes_, decoded_bytes = 0;
  for (ChunkInfo& chunk : std::span(chunks_, chunk_count_)) {
    const auto bad = [&](Status status, const char* reason) {
      return makeFault(status, chunk.offset, "%.*s/%.*s: %s", int(chunk.section.size()), chunk.section.data(), int(chunk.name.size()),
                       chunk.name.data(), reason);
    };
    if (chunk.offset % kAlignment != 0) return bad(Status::bad_chunk, "not at a multiple of 16");
    if (chunk.offset < alignUp(end)) return bad(Status::bad_chunk, "overlaps what precedes it");
    if (chunk.offset > source_.bytes || chunk.stored_bytes > source_.bytes - chunk.offset)
      return bad(Status::bad_chunk, "reaches past the end of the file");
    if (chunk.offset > alignUp(end)) return bad(Status::trailing_bytes, "bytes before it belong to no chunk");
    if (const Status status = sizeChunk(chunk); status != Status::ok) return bad(status, "shape and stored size cannot be");
    if (chunk.raw_bytes > limits_.decoded_bytes - decoded_bytes || chunk.raw_bytes > SIZE_MAX / 2)
      return bad(Status::limit_exceeded, "the decoded file is larger than the limit");
    decoded_bytes += chunk.raw_bytes;
    end = chunk.offset + chunk.stored_bytes;
  }
  if (end != source_.bytes) return makeFault(Status::trailing_bytes, end, "bytes at the end belong to no chunk");
  return {};
}

const SectionInfo* View::findSection(std::string_view type) const {
  for (const SectionInfo& section : sections())
    if (section.type == type) return &section;
  return nullptr;
}

const ChunkInfo* View::findChunk(std::string_view section, std::string_view name) const {
  const std::pair key{section, name};
  const NameOrder order{chunks_};
  const uint32_t *begin = chunk_order_, *end = begin + chunk_count_;
  const uint32_t* found = std::lower_bound(begin, end, key, [&](uint32_t i, const auto& k) { return order.key(i) < k; });
  return found != end && order.key(*found) == key ? &chunks_[*found] : nullptr;
}

}  // namespace lightwell::format
