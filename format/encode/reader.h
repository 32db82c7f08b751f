// Reading a container in the tools: the decoding half with exceptions, vectors and the generated messages.
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "format/decode/view.h"
#include "format/encode/writer.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {

/// The container is damaged, too new or beyond the limits (exit code 4).
class ContainerError : public std::runtime_error {
 public:
  ContainerError(std::string file, const Fault& fault);
  std::string file;
  Status status;
  uint64_t offset;   // byte of the file
  std::string reason;
};

class Reader {
 public:
  /// Throws ContainerError; std::system_error when the file cannot be opened.
  explicit Reader(const std::filesystem::path& file, const Limits& limits = {});
  /// A container in memory; `name` stands for the file in messages.
  explicit Reader(std::vector<uint8_t> bytes, std::string name = "container", const Limits& limits = {});

  const View& view() const { return view_; }
  const std::string& file() const { return file_; }
  /// Whether the file has a section of this type in a version that this code knows.
  bool has(std::string_view section) const;
  bool has(std::string_view section, std::string_view chunk) const { return view_.findChunk(section, chunk) != nullptr; }
  /// Throws ContainerError (bad_section) when there is no such chunk.
  const ChunkInfo& chunk(std::string_view section, std::string_view name) const;

  /// The elements of a chunk. T must be the memory type of `element` (uint16_t for F16, uint32_t for RGB9E5). Throws ContainerError when
  /// the chunk is missing, of another element type, or damaged.
  template <class T>
  std::vector<T> read(std::string_view section, std::string_view name, ElementType element = detail::elementTypeOf<T>()) const {
    const ChunkInfo& info = chunk(section, name);
    checkElement(info, element);
    std::vector<T> values(info.raw_bytes / sizeof(T));
    decode(info, values.data(), info.raw_bytes);
    return values;
  }
  std::string readBytes(std::string_view section, std::string_view name) const;
  template <class Message>
  Message readMessage(std::string_view section, std::string_view name) const {
    Message message;
    parse(section, name, message);
    return message;
  }
  v1::MetaHeader meta() const { return readMessage<v1::MetaHeader>("meta", "header"); }
  v1::SceneHeader scene() const { return readMessage<v1::SceneHeader>("scene", "header"); }
  v1::AtlasHeader atlas() const { return readMessage<v1::AtlasHeader>("atlas", "header"); }
  v1::EnvironmentHeader environment() const { return readMessage<v1::EnvironmentHeader>("environment", "header"); }
  v1::RadiosityHeader radiosity() const { return readMessage<v1::RadiosityHeader>("radiosity", "header"); }
  v1::LightmapHeader lightmap() const { return readMessage<v1::LightmapHeader>("lightmap", "header"); }
  v1::PointsHeader points() const { return readMessage<v1::PointsHeader>("points", "header"); }
  v1::VplHeader vpl() const { return readMessage<v1::VplHeader>("vpl", "header"); }
  v1::ProbesHeader probes() const { return readMessage<v1::ProbesHeader>("probes", "header"); }
  v1::PrmProbesHeader prmProbes() const { return readMessage<v1::PrmProbesHeader>("prm_probes", "header"); }
  v1::PrmHeader prm() const { return readMessage<v1::PrmHeader>("prm", "header"); }

 private:
  void open(const Source& source, const Limits& limits);
  void checkElement(const ChunkInfo& info, ElementType element) const;
  void decode(const ChunkInfo& info, void* destination, size_t bytes) const;
  void parse(std::string_view section, std::string_view name, google::protobuf::Message& message) const;

  std::string file_;
  std::unique_ptr<FileSource> file_source_;
  std::vector<uint8_t> bytes_;
  View view_;
};

}  // namespace lightwell::format
