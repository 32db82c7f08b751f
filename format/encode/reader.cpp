#include "format/encode/reader.h"

#include <google/protobuf/message.h>
#include <google/protobuf/stubs/logging.h>

#include <cerrno>
#include <system_error>

#include "format/encode/strict_message.h"

namespace lightwell::format {

ContainerError::ContainerError(std::string file, const Fault& fault)
    : std::runtime_error(file + ": byte " + std::to_string(fault.offset) + ": " + fault.what + " (" + statusName(fault.status) + ")"),
      file(std::move(file)), status(fault.status), offset(fault.offset), reason(fault.what) {}

Reader::Reader(const std::filesystem::path& file, const Limits& limits)
    : file_(file.string()), file_source_(std::make_unique<FileSource>()) {
  if (!file_source_->open(file.c_str())) throw std::system_error(errno, std::generic_category(), file_);
  open(file_source_->source(), limits);
}

Reader::Reader(std::vector<uint8_t> bytes, std::string name, const Limits& limits) : file_(std::move(name)), bytes_(std::move(bytes)) {
  open(memorySource(bytes_.data(), bytes_.size()), limits);
}

void Reader::open(const Source& source, const Limits& limits) {
  if (const Fault fault = view_.open(source, {.limits = limits})) throw ContainerError(file_, fault);
}

bool Reader::has(std::string_view section) const {
  const SectionInfo* info = view_.findSection(section);
  return info && info->known;
}

const ChunkInfo& Reader::chunk(std::string_view section, std::string_view name) const {
  if (const ChunkInfo* info = view_.findChunk(section, name)) return *info;
  const std::string place = std::string(section) + "/" + std::string(name);
  throw ContainerError(file_, makeFault(Status::bad_section, 0, "%s: missing", place.c_str()));
}

void Reader::checkElement(const ChunkInfo& info, ElementType element) const {
  if (info.element == element) return;
  const std::string place = std::string(info.section) + "/" + std::string(info.name);
  throw ContainerError(file_, makeFault(Status::bad_section, info.offset, "%s: has another element type than expected", place.c_str()));
}

void Reader::decode(const ChunkInfo& info, void* destination, size_t bytes) const {
  if (const Fault fault = view_.decode(info, destination, bytes)) throw ContainerError(file_, fault);
}

std::string Reader::readBytes(std::string_view section, std::string_view name) const {
  const ChunkInfo& info = chunk(section, name);
  checkElement(info, ElementType::bytes);
  std::string bytes(info.raw_bytes, '\0');
  decode(info, bytes.data(), bytes.size());
  return bytes;
}

void Reader::parse(std::string_view section, std::string_view name, google::protobuf::Message& message) const {
  const google::protobuf::LogSilencer silencer;  // the exception says it
  if (parseStrictly(readBytes(section, name), message)) return;
  const std::string place = std::string(section) + "/" + std::string(name);
  throw ContainerError(file_, makeFault(Status::bad_section, chunk(section, name).offset, "%s: not a valid message", place.c_str()));
}

}  // namespace lightwell::format
