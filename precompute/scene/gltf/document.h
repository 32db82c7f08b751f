// A glTF file opened: its JSON, and its buffers and buffer views, read and decompressed when first asked for.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "precompute/core/diagnostics.h"
#include "precompute/scene/file_table.h"
#include "precompute/scene/json_value.h"

namespace lightwell::scene::gltf {

/// Bytes of a buffer view. `stride` is 0 when the elements are tightly packed.
struct BufferView {
  std::span<const uint8_t> bytes;
  size_t stride = 0;
};

class Document {
 public:
  /// Opens a .glb or .gltf (told apart by content). Checks the container, the JSON, the glTF version and the required extensions.
  /// `table`, which must outlive it, may be null: `file` and the files it names are then those of the file system.
  Document(const std::filesystem::path& file, const FileTable* table, Diagnostics& diagnostics);
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;

  const std::string& file() const { return file_; }
  /// The bytes behind a `uri` member (readUri).
  std::vector<uint8_t> external(const JsonValue& uri) const;
  JsonValue root() const { return JsonValue(file_, json_); }
  /// The length of a top-level array; 0 when absent.
  size_t count(const char* array) const;
  /// An element of a top-level array, e.g. element("accessors", 3).
  JsonValue element(const char* array, size_t i) const { return root().at(array)[i]; }
  /// The element of a top-level array that `reference` (an index) names.
  JsonValue element(const char* array, const JsonValue& reference) const {
    return element(array, reference.index(count(array), array));
  }

  /// The buffer view that `reference` (an index) names, decompressed if need be. Valid as long as the document.
  BufferView view(const JsonValue& reference);
  /// A stretch of a buffer named by members `buffer`, `byteOffset` and `byteLength` of `range`.
  std::span<const uint8_t> range(const JsonValue& range);

 private:
  std::span<const uint8_t> buffer(const JsonValue& reference);

  std::string file_;
  std::filesystem::path folder_;
  const FileTable* table_;
  std::vector<uint8_t> bytes_;            // the whole file
  std::span<const uint8_t> binary_chunk_;
  bool has_binary_chunk_ = false;
  nlohmann::json json_;
  std::map<size_t, std::vector<uint8_t>> loaded_buffers_, decompressed_views_;
};

}  // namespace lightwell::scene::gltf
