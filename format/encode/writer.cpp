#include "format/encode/writer.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>
#include <google/protobuf/message_lite.h>

#include "format/decode/checksum.h"
#include "format/decode/endian.h"
#include "format/encode/atomic_file.h"
#include "format/encode/compress.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

static_assert(std::endian::native == std::endian::little, "the tools run on little-endian hosts; readers run on any");

/// The same message gives the same bytes.
std::string serialize(const google::protobuf::MessageLite& message) {
  std::string bytes;
  {
    google::protobuf::io::StringOutputStream string_stream(&bytes);
    google::protobuf::io::CodedOutputStream stream(&string_stream);
    stream.SetSerializationDeterministic(true);
    if (!message.SerializeToCodedStream(&stream)) throw std::invalid_argument("a message cannot be serialized");
  }
  return bytes;
}

void checkName(std::string_view name) {
  const auto allowed = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  if (name.empty() || name.size() > kMaxNameBytes || !std::all_of(name.begin(), name.end(), allowed))
    throw std::invalid_argument("not a name of the container: \"" + std::string(name) + "\"");
}

}  // namespace

const Writer::Chunk* Writer::find(std::string_view section, std::string_view name) const {
  for (const Chunk& chunk : chunks_)
    if (chunk.section == section && chunk.name == name) return &chunk;
  return nullptr;
}

void Writer::addSection(std::string_view type, uint32_t version, bool required) {
  checkName(type);
  if (version == 0) throw std::invalid_argument("section versions start at 1");
  for (const Section& section : sections_)
    if (section.type == type) throw std::invalid_argument("section " + section.type + " is declared twice");
  sections_.push_back({std::string(type), version, required});
}

void Writer::addRaw(std::string_view section, std::string_view name, ElementType element, std::span<const std::byte> data,
                    std::span<const uint64_t> shape) {
  checkName(name);
  const std::string place = std::string(section) + "/" + std::string(name);
  if (std::none_of(sections_.begin(), sections_.end(), [&](const Section& s) { return s.type == section; }))
    throw std::invalid_argument(place + ": the section is not declared");
  if (find(section, name)) throw std::invalid_argument(place + ": added twice");
  uint64_t bytes = elementBytes(element);
  for (const uint64_t extent : shape) bytes *= extent;
  if (shape.size() > kMaxRank || elementBytes(element) == 0 || bytes != data.size())
    throw std::invalid_argument(place + ": the shape does not fit " + std::to_string(data.size()) + " bytes");

  Encoded encoded = encodeSmallest(element, {reinterpret_cast<const uint8_t*>(data.data()), data.size()}, options_.zstd_level);
  const uint64_t sum = checksum(encoded.stored.data(), encoded.stored.size());
  chunks_.push_back({std::string(section), std::string(name), element, encoded.codec, {shape.begin(), shape.end()}, sum,
                     std::move(encoded.stored)});
}

void Writer::addStored(const ChunkInfo& chunk, std::span<const uint8_t> stored) {
  if (stored.size() != chunk.stored_bytes || checksum(stored.data(), stored.size()) != chunk.checksum) throw std::invalid_argument("not the bytes of the chunk");
  if (std::none_of(sections_.begin(), sections_.end(), [&](const Section& s) { return s.type == chunk.section; }) || find(chunk.section, chunk.name))
    throw std::invalid_argument(std::string(chunk.section) + "/" + std::string(chunk.name) + ": added twice, or its section is not declared");
  chunks_.push_back({std::string(chunk.section), std::string(chunk.name), chunk.element, chunk.codec, {chunk.shape, chunk.shape + chunk.rank}, chunk.checksum, {stored.begin(), stored.end()}});
}

void Writer::addMessage(std::string_view section, std::string_view name, const google::protobuf::MessageLite& message) {
  const std::string bytes = serialize(message);
  const uint64_t size = bytes.size();
  addRaw(section, name, ElementType::bytes, std::as_bytes(std::span(bytes)), {&size, 1});
}

uint64_t Writer::storedBytes(std::string_view section, std::string_view name) const {
  const Chunk* chunk = find(section, name);
  if (!chunk) throw std::invalid_argument("no chunk " + std::string(section) + "/" + std::string(name));
  return chunk->stored.size();
}

std::vector<uint8_t> Writer::head() const {
  v1::Directory directory;
  for (const Section& section : sections_) {
    v1::Section& entry = *directory.add_sections();
    entry.set_type(section.type);
    entry.set_version(section.version);
    entry.set_required(section.required);
  }
  for (const Chunk& chunk : chunks_) {
    v1::Chunk& entry = *directory.add_chunks();
    entry.set_section(chunk.section);
    entry.set_name(chunk.name);
    entry.set_element(v1::ElementType(chunk.element));
    entry.mutable_shape()->Add(chunk.shape.begin(), chunk.shape.end());
    entry.set_codec(v1::Codec(chunk.codec));
    entry.set_stored_bytes(chunk.stored.size());
    entry.set_checksum(chunk.checksum);
  }
  // Offsets depend on the directory's size and, through their own lengths, it on them. Both only grow: the loop ends.
  uint64_t file_bytes = 0, directory_bytes = 0;
  for (uint64_t assumed = ~uint64_t(0); assumed != directory_bytes;) {
    assumed = directory_bytes;
    file_bytes = kHeaderBytes + directory_bytes;
    for (size_t i = 0; i < chunks_.size(); ++i) {
      directory.mutable_chunks(int(i))->set_offset(alignUp(file_bytes));
      file_bytes = alignUp(file_bytes) + chunks_[i].stored.size();
    }
    directory_bytes = directory.ByteSizeLong();
  }
  const std::string message = serialize(directory);

  std::vector<uint8_t> head(chunks_.empty() ? file_bytes : alignUp(kHeaderBytes + directory_bytes));
  std::copy(std::begin(kMagic), std::end(kMagic), head.begin());
  storeLittle(&head[8], kVersionMajor);
  storeLittle(&head[10], kVersionMinor);
  storeLittle(&head[16], file_bytes);
  storeLittle(&head[24], uint64_t(kHeaderBytes));
  storeLittle(&head[32], directory_bytes);
  storeLittle(&head[40], checksum(message.data(), message.size()));
  storeLittle(&head[56], checksum(head.data(), 56));
  std::copy(message.begin(), message.end(), head.begin() + kHeaderBytes);
  return head;
}

std::vector<std::span<const uint8_t>> Writer::pieces(std::span<const uint8_t> head) const {
  static constexpr uint8_t zeros[kAlignment] = {};
  std::vector<std::span<const uint8_t>> pieces{head};
  for (const Chunk& chunk : chunks_) {
    pieces.push_back(chunk.stored);
    const bool last = &chunk == &chunks_.back();
    pieces.push_back({zeros, last ? 0 : size_t(alignUp(chunk.stored.size()) - chunk.stored.size())});
  }
  return pieces;
}

std::vector<uint8_t> Writer::bytes() const {
  const std::vector<uint8_t> first = head();
  std::vector<uint8_t> file;
  for (const std::span<const uint8_t> piece : pieces(first)) file.insert(file.end(), piece.begin(), piece.end());
  return file;
}

void Writer::write(const std::filesystem::path& file) const {
  const std::vector<uint8_t> first = head();
  writeFileAtomically(file, pieces(first));
}

}  // namespace lightwell::format
