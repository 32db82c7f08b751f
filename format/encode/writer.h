// Making a container: sections and typed chunks in, deterministic bytes out.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "format/decode/layout.h"
#include "format/decode/view.h"

namespace google::protobuf {
class MessageLite;
}

namespace lightwell::format {

namespace detail {
template <class T>
constexpr ElementType elementTypeOf() {
  if constexpr (std::is_same_v<T, uint8_t>) return ElementType::u8;
  else if constexpr (std::is_same_v<T, int8_t>) return ElementType::i8;
  else if constexpr (std::is_same_v<T, uint16_t>) return ElementType::u16;
  else if constexpr (std::is_same_v<T, int16_t>) return ElementType::i16;
  else if constexpr (std::is_same_v<T, uint32_t>) return ElementType::u32;
  else { static_assert(std::is_same_v<T, float>, "not an element type of the container"); return ElementType::f32; }
}
}  // namespace detail

struct WriterOptions {
  int zstd_level = 3;  // 1 to 19. The codec of a chunk does not depend on it
};

/// Collects sections and chunks in the order of the calls. Every call throws std::invalid_argument on misuse (bad or duplicate names,
/// an undeclared section, a shape that does not fit the data): that is a bug of the caller.
class Writer {
 public:
  explicit Writer(const WriterOptions& options = {}) : options_(options) {}

  /// `required`: a reader that does not know the section must reject the file.
  void addSection(std::string_view type, uint32_t version = 1, bool required = true);

  /// `data` holds the product of `shape` elements in the host's byte order. Compressed at once: the data may be freed afterwards. The
  /// codec that makes the chunk smallest is taken.
  void addRaw(std::string_view section, std::string_view name, ElementType element, std::span<const std::byte> data,
              std::span<const uint64_t> shape);

  /// Typed data; an empty shape means one-dimensional. `element` is needed for F16 (uint16_t) and RGB9E5 (uint32_t).
  ///   writer.add("geometry", "position", std::span<const float>(positions), {vertex_count, 3});
  template <class T>
  void add(std::string_view section, std::string_view name, std::span<const T> data, std::initializer_list<uint64_t> shape = {},
           ElementType element = detail::elementTypeOf<T>()) {
    static_assert(sizeof(T) <= 4);
    const uint64_t count = data.size();
    addRaw(section, name, element, std::as_bytes(data),
           shape.size() ? std::span<const uint64_t>(shape.begin(), shape.size()) : std::span<const uint64_t>(&count, 1));
  }
  template <class T>
  void add(std::string_view section, std::string_view name, const std::vector<T>& data, std::initializer_list<uint64_t> shape = {},
           ElementType element = detail::elementTypeOf<T>()) {
    add(section, name, std::span<const T>(data), shape, element);
  }

  /// A chunk as another file has it: `stored` are its bytes there.
  void addStored(const ChunkInfo& chunk, std::span<const uint8_t> stored);

  /// A serialized message as a chunk of BYTES.
  void addMessage(std::string_view section, std::string_view name, const google::protobuf::MessageLite& message);

  /// Bytes that the chunk takes in the file, without padding.
  uint64_t storedBytes(std::string_view section, std::string_view name) const;

  /// The whole file. The same calls give the same bytes.
  std::vector<uint8_t> bytes() const;
  /// bytes() to a file, all or nothing (see atomic_file.h). Throws std::runtime_error naming the file.
  void write(const std::filesystem::path& file) const;

 private:
  struct Section {
    std::string type;
    uint32_t version;
    bool required;
  };
  struct Chunk {
    std::string section, name;
    ElementType element;
    Codec codec;
    std::vector<uint64_t> shape;
    uint64_t checksum;
    std::vector<uint8_t> stored;
  };
  std::vector<uint8_t> head() const;  // header, directory and its padding
  std::vector<std::span<const uint8_t>> pieces(std::span<const uint8_t> head) const;
  const Chunk* find(std::string_view section, std::string_view name) const;

  WriterOptions options_;
  std::vector<Section> sections_;
  std::vector<Chunk> chunks_;
};

}  // namespace lightwell::format
