#include "tests/format/forge.h"

#include <algorithm>
#include <stdexcept>

#include "format/decode/checksum.h"
#include "format/decode/endian.h"

namespace lightwell::format {

v1::Section& Forge::section(std::string_view type, uint32_t version, bool required) {
  v1::Section& entry = *directory.add_sections();
  entry.set_type(std::string(type));
  entry.set_version(version);
  entry.set_required(required);
  return entry;
}

v1::Chunk& Forge::chunk(std::string_view section, std::string_view name, ElementType element, std::vector<uint64_t> shape, Codec codec,
                        std::string stored_bytes) {
  uint64_t end = kHeaderBytes + kDirectoryBytes;
  for (const std::string& bytes : stored) end = alignUp(end) + bytes.size();
  v1::Chunk& entry = *directory.add_chunks();
  entry.set_section(std::string(section));
  entry.set_name(std::string(name));
  entry.set_element(v1::ElementType(element));
  entry.mutable_shape()->Add(shape.begin(), shape.end());
  entry.set_codec(v1::Codec(codec));
  entry.set_offset(alignUp(end));
  entry.set_stored_bytes(stored_bytes.size());
  entry.set_checksum(checksum(stored_bytes.data(), stored_bytes.size()));
  stored.push_back(std::move(stored_bytes));
  return entry;
}

std::vector<uint8_t> Forge::build() const {
  std::string message = directory.SerializeAsString();
  if (message.size() + 3 > kDirectoryBytes) throw std::logic_error("the forged directory is too large");
  // Field 15, length-delimited, with a length of two bytes.
  const size_t fill = kDirectoryBytes - message.size() - 3;
  message += {char(15 << 3 | 2), char(0x80 | (fill & 0x7f)), char(fill >> 7)};
  message.append(fill, '\0');
  std::string rest;
  for (const std::string& bytes : stored) {
    rest.resize(alignUp(rest.size()), '\0');
    rest += bytes;
  }
  return assemble(message, rest);
}

std::vector<uint8_t> assemble(std::string_view directory, std::string_view rest) {
  const uint64_t first = rest.empty() ? kHeaderBytes + directory.size() : alignUp(kHeaderBytes + directory.size());
  std::vector<uint8_t> file(first + rest.size());
  std::copy(std::begin(kMagic), std::end(kMagic), file.begin());
  storeLittle(&file[8], kVersionMajor);
  storeLittle(&file[10], kVersionMinor);
  storeLittle(&file[16], uint64_t(file.size()));
  storeLittle(&file[24], uint64_t(kHeaderBytes));
  storeLittle(&file[32], uint64_t(directory.size()));
  std::copy(directory.begin(), directory.end(), file.begin() + kHeaderBytes);
  std::copy(rest.begin(), rest.end(), file.begin() + ptrdiff_t(first));
  fixChecksums(file);
  return file;
}

void fixChecksums(std::vector<uint8_t>& file) {
  const uint64_t directory_bytes = loadLittle<uint64_t>(&file[32]);
  if (directory_bytes <= file.size() - kHeaderBytes) storeLittle(&file[40], checksum(file.data() + kHeaderBytes, directory_bytes));
  storeLittle(&file[56], checksum(file.data(), 56));
}

}  // namespace lightwell::format
