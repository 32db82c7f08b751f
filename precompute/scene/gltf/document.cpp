#include "precompute/scene/gltf/document.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "precompute/core/error.h"
#include "precompute/scene/gltf/files.h"
#include "precompute/scene/gltf/limits.h"
#include "precompute/scene/gltf/meshopt.h"

namespace lightwell::scene::gltf {
namespace {

constexpr uint32_t kGlbMagic = 0x46546C67, kJsonChunk = 0x4E4F534A, kBinaryChunk = 0x004E4942;

constexpr std::array<std::string_view, 10> kSupported = {
    "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "EXT_texture_webp",
    "KHR_draco_mesh_compression", "KHR_lights_punctual", "KHR_materials_emissive_strength",
    "KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit", "KHR_mesh_quantization",
    "KHR_texture_transform"};
/// Change only what a mirror direction shows, or nothing at all: a diffuse bake may leave them out.
constexpr std::array<std::string_view, 9> kHarmless = {
    "KHR_materials_anisotropy", "KHR_materials_clearcoat", "KHR_materials_dispersion", "KHR_materials_ior", "KHR_materials_iridescence",
    "KHR_materials_sheen", "KHR_materials_specular", "KHR_materials_variants", "KHR_xmp_json_ld"};

bool contains(std::span<const std::string_view> list, std::string_view name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

uint32_t readU32(std::span<const uint8_t> bytes, size_t offset) {
  uint32_t value;
  std::memcpy(&value, bytes.data() + offset, 4);
  return value;
}

struct Chunks {
  std::span<const uint8_t> json, binary;
  bool has_binary = false;
};

/// glTF 2.0, section 4.4 (binary glTF). Unknown chunks are skipped, as it says.
Chunks splitGlb(const std::string& file, std::span<const uint8_t> bytes) {
  const auto fail = [&](const char* reason) { throw InputError(file, "", reason); };
  if (bytes.size() < 20) fail("the binary glTF ends inside its header");
  if (readU32(bytes, 4) != 2) fail("only version 2 of binary glTF is known");
  const size_t length = readU32(bytes, 8);
  if (length > bytes.size()) fail("the binary glTF is cut short: its header promises more bytes");
  Chunks chunks;
  bool first = true;
  for (size_t offset = 12; offset < length;) {
    if (length - offset < 8) fail("the binary glTF ends inside a chunk header");
    const size_t chunk_length = readU32(bytes, offset);
    const uint32_t type = readU32(bytes, offset + 4);
    offset += 8;
    if (chunk_length > length - offset) fail("a chunk of the binary glTF reaches past its end");
    const auto chunk = bytes.subspan(offset, chunk_length);
    if (first && type != kJsonChunk) fail("the first chunk of the binary glTF is not JSON");
    if (first) chunks.json = chunk;
    else if (type == kBinaryChunk && !chunks.has_binary) {
      chunks.binary = chunk;
      chunks.has_binary = true;
    }
    first = false;
    offset += std::min((chunk_length + 3) & ~size_t(3), length - offset);
  }
  return chunks;
}

void checkVersion(const JsonValue& root) {
  const JsonValue asset = root.at("asset");
  const JsonValue version = asset.at("version");
  if (!version.string().starts_with("2.")) version.fail("is " + version.string() + "; only glTF 2 is known");
  if (const auto minimum = asset.find("minVersion"); minimum && minimum->string() != "2.0")
    minimum->fail("is " + minimum->string() + "; only glTF 2.0 is known");
}

void checkExtensions(const JsonValue& root, Diagnostics& diagnostics) {
  if (const auto required = root.find("extensionsRequired"))
    for (size_t i = 0; i < required->size(); ++i) {
      const JsonValue name = (*required)[i];
      if (!contains(kSupported, name.string()) && !contains(kHarmless, name.string()))
        name.fail("the scene requires the extension " + name.string() + ", which is not known");
    }
  if (const auto used = root.find("extensionsUsed"))
    for (size_t i = 0; i < used->size(); ++i) {
      const JsonValue name = (*used)[i];
      if (!contains(kSupported, name.string())) diagnostics.warn(name.path(), "the extension " + name.string() + " is left out");
    }
}

}  // namespace

Document::Document(const std::filesystem::path& file, const FileTable* table, Diagnostics& diagnostics)
    : file_(file.string()), folder_(file.has_parent_path() ? file.parent_path() : "."), table_(table),
      bytes_(readFile(file, kMaxFileBytes, table)) {
  std::span<const uint8_t> json = bytes_;
  if (bytes_.size() >= 4 && readU32(bytes_, 0) == kGlbMagic) {
    const Chunks chunks = splitGlb(file_, bytes_);
    json = chunks.json;
    binary_chunk_ = chunks.binary;
    has_binary_chunk_ = chunks.has_binary;
  }
  while (!json.empty() && json.back() == 0) json = json.first(json.size() - 1);  // some exporters pad with zeros instead of blanks
  if (json.size() > kMaxJsonBytes) throw InputError(file_, "", "holds more than " + std::to_string(kMaxJsonBytes) + " bytes of JSON");
  json_ = parseJson(file_, {reinterpret_cast<const char*>(json.data()), json.size()});
  checkVersion(root());
  checkExtensions(root(), diagnostics);
}

std::vector<uint8_t> Document::external(const JsonValue& uri) const { return readUri(folder_, uri, kMaxFileBytes, table_); }

size_t Document::count(const char* array) const {
  const auto found = root().find(array);
  return found ? found->size() : 0;
}

std::span<const uint8_t> Document::buffer(const JsonValue& reference) {
  const size_t i = reference.index(count("buffers"), "buffers");
  const JsonValue buffer = element("buffers", i);
  const size_t length = buffer.at("byteLength").unsignedInteger();
  const auto uri = buffer.find("uri");
  std::span<const uint8_t> bytes;
  if (uri) {
    auto it = loaded_buffers_.find(i);
    if (it == loaded_buffers_.end()) it = loaded_buffers_.emplace(i, external(*uri)).first;
    bytes = it->second;
  } else if (i == 0 && has_binary_chunk_) {
    bytes = binary_chunk_;
  } else {
    buffer.fail("has neither a uri nor a binary chunk");
  }
  if (bytes.size() < length)
    buffer.at("byteLength").fail("is " + std::to_string(length) + ", but the data has " + std::to_string(bytes.size()) + " bytes");
  return bytes.first(length);
}

std::span<const uint8_t> Document::range(const JsonValue& range) {
  const auto bytes = buffer(range.at("buffer"));
  const size_t offset = range.unsignedOr("byteOffset", 0), length = range.at("byteLength").unsignedInteger();
  if (offset > bytes.size() || length > bytes.size() - offset)
    range.fail("bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) + " reach past the buffer's " +
               std::to_string(bytes.size()));
  return bytes.subspan(offset, length);
}

BufferView Document::view(const JsonValue& reference) {
  const size_t i = reference.index(count("bufferViews"), "bufferViews");
  const JsonValue view = element("bufferViews", i);
  BufferView result;
  result.stride = view.unsignedOr("byteStride", 0);
  if (const auto compressed = view.extension("EXT_meshopt_compression")) {
    auto it = decompressed_views_.find(i);
    if (it == decompressed_views_.end()) it = decompressed_views_.emplace(i, decodeMeshopt(*compressed, range(*compressed))).first;
    result.bytes = it->second;
    return result;
  }
  result.bytes = range(view);
  return result;
}

}  // namespace lightwell::scene::gltf
