// Changes a container where it matters: values of decoded chunks, headers, the directory; then codes the chunks again and puts all sizes, places and checksums right, so that the
// change reaches the code behind them.
#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "format/decode/checksum.h"
#include "format/encode/compress.h"
#include "format/encode/reader.h"
#include "tests/format/forge.h"
#include "tests/fuzz/message_mutator.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

namespace lightwell::fuzz {
namespace {
using namespace lightwell::format;

struct Parts {
  v1::Directory directory;
  std::vector<std::string> stored;
};

Parts partsOf(const Reader& reader, const uint8_t* data) {
  Parts parts;
  for (const SectionInfo& section : reader.view().sections()) {
    v1::Section& s = *parts.directory.add_sections();
    s.set_type(std::string(section.type)), s.set_version(section.version), s.set_required(section.required);
  }
  for (const ChunkInfo& chunk : reader.view().chunks()) {
    v1::Chunk& c = *parts.directory.add_chunks();
    c.set_section(std::string(chunk.section)), c.set_name(std::string(chunk.name));
    c.set_element(v1::ElementType(int(chunk.element))), c.set_codec(v1::Codec(int(chunk.codec)));
    for (uint32_t i = 0; i < chunk.rank; ++i) c.add_shape(chunk.shape[i]);
    parts.stored.emplace_back(reinterpret_cast<const char*>(data) + chunk.offset, chunk.stored_bytes);
  }
  return parts;
}

std::vector<uint8_t> assembled(Parts& parts) {
  // Offsets are varints: their width and the size of the directory settle after a few rounds.
  std::string message, rest;
  size_t size = 0;
  for (int round = 0; round < 4; ++round) {
    rest.clear();
    const uint64_t first = alignUp(kHeaderBytes + size);
    for (int i = 0; i < parts.directory.chunks_size(); ++i) {
      rest.resize(alignUp(rest.size()), '\0');
      v1::Chunk& chunk = *parts.directory.mutable_chunks(i);
      chunk.set_offset(first + rest.size());
      chunk.set_stored_bytes(parts.stored[size_t(i)].size());
      chunk.set_checksum(checksum(parts.stored[size_t(i)].data(), parts.stored[size_t(i)].size()));
      rest += parts.stored[size_t(i)];
    }
    message = parts.directory.SerializeAsString();
    if (message.size() == size) break;
    size = message.size();
  }
  return assemble(message, rest);
}

std::unique_ptr<google::protobuf::Message> headerOf(const v1::Chunk& chunk) {
  if (chunk.name() == "alpha_material") return std::make_unique<v1::AlphaMaterials>();
  if (chunk.name() != "header") return nullptr;
  if (chunk.section() == "meta") return std::make_unique<v1::MetaHeader>();
  if (chunk.section() == "scene") return std::make_unique<v1::SceneHeader>();
  if (chunk.section() == "atlas") return std::make_unique<v1::AtlasHeader>();
  if (chunk.section() == "prm") return std::make_unique<v1::PrmHeader>();
  if (chunk.section() == "prm_probes") return std::make_unique<v1::PrmProbesHeader>();
  if (chunk.section() == "environment") return std::make_unique<v1::EnvironmentHeader>();
  if (chunk.section() == "radiosity") return std::make_unique<v1::RadiosityHeader>();
  if (chunk.section() == "probes") return std::make_unique<v1::ProbesHeader>();
  if (chunk.section() == "lightmap") return std::make_unique<v1::LightmapHeader>();
  if (chunk.section() == "vpl") return std::make_unique<v1::VplHeader>();
  if (chunk.section() == "points") return std::make_unique<v1::PointsHeader>();
  return nullptr;
}

/// One to three elements to odd values or to that of another element.
void mutateElements(std::string& values, ElementType element, Random& random) {
  const size_t bytes = elementBytes(element), count = bytes ? values.size() / bytes : 0;
  if (count == 0) return;
  for (uint32_t n = 1 + random() % 3; n > 0; --n) {
    char* at = values.data() + random() % count * bytes;
    if (random() % 4 == 0) {
      std::memmove(at, values.data() + random() % count * bytes, bytes);
    } else if (element == ElementType::f32) {
      const float value = float(oddReal(random));
      std::memcpy(at, &value, 4);
    } else {
      uint64_t value = 0;
      std::memcpy(&value, at, bytes);
      value = random() % 2 ? oddNumber(random) : value + random() % 5 - 2;
      std::memcpy(at, &value, bytes);
    }
  }
}

/// The chunk with `values`, which may have become longer or shorter: the slowest extent follows.
void store(v1::Chunk& chunk, std::string& stored, std::string values, Random& random) {
  const auto element = ElementType(chunk.element());
  uint64_t row = elementBytes(element);
  for (int i = 1; i < chunk.shape_size(); ++i) row *= chunk.shape(i);
  if (chunk.shape_size() > 0 && row > 0 && values.size() % row == 0) chunk.set_shape(0, values.size() / row);
  auto codec = Codec(1 + random() % 4);
  if (values.empty() || !codecAllowed(codec, element)) codec = Codec::raw;
  chunk.set_codec(v1::Codec(int(codec)));
  const auto coded = encodeWith(codec, element, {reinterpret_cast<const uint8_t*>(values.data()), values.size()}, 1);
  stored.assign(coded.begin(), coded.end());
}

void mutateChunk(const Reader& reader, const ChunkInfo& info, v1::Chunk& chunk, std::string& stored, Random& random) {
  if (random() % 16 == 0) {  // what the decompressor reads
    stored = mutatedBytes(std::move(stored), stored.size() + 16);
    return;
  }
  std::string values(info.raw_bytes, '\0');
  if (!info.decodable || info.raw_bytes > 1 << 20 || reader.view().decode(info, values.data(), values.size())) return;
  if (const auto header = headerOf(chunk); header && header->ParseFromString(values)) {
    mutateMessage(*header, random);
    values = header->SerializeAsString();
  } else if (random() % 8 == 0) {
    values = mutatedBytes(std::move(values), values.size() + 64);
  } else {
    mutateElements(values, ElementType(chunk.element()), random);
  }
  store(chunk, stored, std::move(values), random);
}

size_t mutate(uint8_t* data, size_t size, size_t most, Random& random) {
  const Reader reader(std::vector<uint8_t>(data, data + size), "", {.decoded_bytes = 1 << 22});
  Parts parts = partsOf(reader, data);
  const int chunks = parts.directory.chunks_size();
  const int index = chunks ? int(random() % uint32_t(chunks)) : 0;
  const uint32_t choice = random() % 16;
  if (choice == 0) {
    const int count = chunks;
    mutateMessage(parts.directory, random);
    parts.stored.resize(size_t(std::max(parts.directory.chunks_size(), count)));
  } else if (choice == 1 && chunks > 0) {  // a chunk is missing
    parts.directory.mutable_chunks()->DeleteSubrange(index, 1);
    parts.stored.erase(parts.stored.begin() + index);
  } else if (choice == 2 && chunks > 0 && parts.directory.chunks(index).shape_size() > 0) {  // one that lies about its shape
    v1::Chunk& chunk = *parts.directory.mutable_chunks(index);
    chunk.set_shape(int(random() % uint32_t(chunk.shape_size())), oddNumber(random));
  } else if (chunks > 0) {
    mutateChunk(reader, reader.view().chunks()[size_t(index)], *parts.directory.mutable_chunks(index), parts.stored[size_t(index)], random);
  } else {
    return LLVMFuzzerMutate(data, size, most);
  }
  const std::vector<uint8_t> file = assembled(parts);
  if (file.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::copy(file.begin(), file.end(), data);
  return file.size();
}

}  // namespace
}  // namespace lightwell::fuzz

extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  lightwell::fuzz::Random random(seed + 1);
  if (random() % 16) {
    try {
      return lightwell::fuzz::mutate(data, size, most, random);
    } catch (const std::exception&) {  // no container, or none any more
    }
  }
  size = LLVMFuzzerMutate(data, size, most);
  if (size >= lightwell::format::kHeaderBytes && random() % 4) {
    std::vector<uint8_t> file(data, data + size);
    lightwell::format::fixChecksums(file);
    std::copy(file.begin(), file.end(), data);
  }
  return size;
}
