// The open container and the decoding of its chunks, shared by the runtime's modules.
#pragma once
#include <string_view>

#include "format/decode/headers.h"
#include "format/decode/view.h"
#include "runtime/src/host.h"

struct lw_container {
  lightwell::runtime::Host host;
  lw_reader reader{};
  lightwell::format::FileSource file;
  lightwell::format::View view;  // after `file`: it must close first
  // Section scene, where it is there and sound; read on opening, so that a light costs no more than itself. Lights have no names.
  bool scene_is_read = false;
  lightwell::format::SceneHeader scene;
  lightwell::runtime::Array<lightwell::format::Light> scene_lights;
};

namespace lightwell::runtime {

/// The chunk, when the section is known and the chunk has this element type; else a reported failure.
lw_result findChunk(const lw_container& container, std::string_view section, std::string_view name, const format::ChunkInfo*& chunk);
lw_result findChunk(const lw_container& container, std::string_view section, std::string_view name, format::ElementType element,
                    const format::ChunkInfo*& chunk);

/// "section/name: reason" as LW_BAD_SECTION.
lw_result badSection(const lw_container& container, const format::ChunkInfo& chunk, const char* reason);

/// Decodes a whole chunk into a new array. T must have the size of `element`, or the chunk be of bytes.
template <class T>
lw_result decodeChunk(const lw_container& container, const format::ChunkInfo& chunk, Array<T>& values) {
  if (chunk.raw_bytes > SIZE_MAX || !values.allocate(container.host, size_t(chunk.raw_bytes / sizeof(T))))
    return container.host.fail(LW_OUT_OF_MEMORY, "%.*s/%.*s: no memory for %llu bytes", int(chunk.section.size()), chunk.section.data(),
                               int(chunk.name.size()), chunk.name.data(), static_cast<unsigned long long>(chunk.raw_bytes));
  if (const format::Fault fault = container.view.decode(chunk, values.data(), values.bytes())) return container.host.fail(fault);
  return LW_OK;
}
/// The same by name, with the element type and the number of elements that the section's table demands.
template <class T>
lw_result decodeChunk(const lw_container& container, std::string_view section, std::string_view name, format::ElementType element,
                      uint64_t elements, Array<T>& values) {
  const format::ChunkInfo* chunk = nullptr;
  if (const lw_result result = findChunk(container, section, name, element, chunk)) return result;
  if (chunk->elements != elements) return badSection(container, *chunk, "its shape contradicts the section's header");
  return decodeChunk(container, *chunk, values);
}

/// Decodes the chunk "header" of a section and hands its bytes to `parse`, which says whether they are a valid message.
template <class Parse>
lw_result readHeader(const lw_container& container, std::string_view section, Parse parse) {
  const format::ChunkInfo* chunk = nullptr;
  lw_result result = findChunk(container, section, "header", chunk);
  if (result) return result;
  if (chunk->element != format::ElementType::bytes) return badSection(container, *chunk, "it is not a message");
  Array<uint8_t> message;
  if ((result = decodeChunk(container, *chunk, message))) return result;
  return parse(message) ? LW_OK : badSection(container, *chunk, "it is not a valid message");
}

lw_result readAtlasHeader(const lw_container& container, format::AtlasHeader& header);
lw_result readEnvironmentHeader(const lw_container& container, format::EnvironmentHeader& header);
lw_result readPrmHeader(const lw_container& container, format::PrmHeader& header);

/// Every texel's source is a texel that is its own source, or none.
bool isSourceMap(const uint32_t* source, uint64_t texels);

/// Every texel of `rgba` ([texels][4]) shows what its source has; texels without one are zero. A value of its own that a buried texel may have is not shown.
void fillFromSources(const uint32_t* source, size_t texels, float* rgba);

inline constexpr uint32_t kNone = 0xffffffffu;

}  // namespace lightwell::runtime
