// Geometry and atlas arrays, and the materials of triangles with alpha.
#include <cmath>
#include <cstdio>
#include <cstring>

#include "format/decode/pixel.h"
#include "format/decode/wire.h"
#include "runtime/src/container.h"

namespace lightwell::runtime {
namespace {

using format::ChunkInfo;
using format::ElementType;

enum class Unpack : uint8_t { none, octahedral, rgb9e5 };

/// How an array is stored and what it becomes.
struct ArrayForm {
  lw_array array;
  const char *section, *chunk;
  ElementType element;
  uint32_t stored_components, components, component_bytes;
  Unpack unpack = Unpack::none;
};

constexpr ArrayForm kForms[] = {
    {LW_ARRAY_POSITION, "geometry", "position", ElementType::f32, 3, 3, 4},
    {LW_ARRAY_NORMAL, "geometry", "normal", ElementType::i16, 2, 3, 4, Unpack::octahedral},
    {LW_ARRAY_LIGHTMAP_UV, "geometry", "lightmap_uv", ElementType::f32, 2, 2, 4},
    {LW_ARRAY_INDEX, "geometry", "index", ElementType::u32, 3, 3, 4},
    {LW_ARRAY_TRIANGLE_FLAGS, "geometry", "triangle_flags", ElementType::u8, 1, 1, 1},
    {LW_ARRAY_ALPHA_UV, "geometry", "alpha_uv", ElementType::f32, 2, 2, 4},
    {LW_ARRAY_TRIANGLE_ALPHA, "geometry", "triangle_alpha", ElementType::u16, 1, 1, 2},
    {LW_ARRAY_ATLAS_SOURCE, "atlas", "source", ElementType::u32, 1, 1, 4},
    {LW_ARRAY_ATLAS_COVERAGE, "atlas", "coverage", ElementType::u8, 1, 1, 1},
    {LW_ARRAY_ATLAS_ALBEDO, "atlas", "albedo", ElementType::u8, 3, 3, 1},
    {LW_ARRAY_ATLAS_EMISSION, "atlas", "emission", ElementType::rgb9e5, 1, 3, 4, Unpack::rgb9e5},
};

bool isAtlas(const ArrayForm& form) { return form.array >= LW_ARRAY_ATLAS_SOURCE; }

/// The vertices or triangles that a geometry array must have as many of: those of the chunk "position" or "index".
lw_result expectedElements(const lw_container& container, const ArrayForm& form, uint64_t& elements) {
  if (isAtlas(form)) {
    format::AtlasHeader header;
    const lw_result result = readAtlasHeader(container, header);
    elements = uint64_t(header.width) * header.height;
    return result;
  }
  const bool per_triangle = form.array == LW_ARRAY_INDEX || form.array == LW_ARRAY_TRIANGLE_FLAGS || form.array == LW_ARRAY_TRIANGLE_ALPHA;
  const ChunkInfo* reference = nullptr;
  if (const lw_result result = findChunk(container, "geometry", per_triangle ? "index" : "position",
                                         per_triangle ? ElementType::u32 : ElementType::f32, reference))
    return result;
  if (reference->rank != 2 || reference->shape[1] != 3) return badSection(container, *reference, "its shape is not [n, 3]");
  elements = reference->shape[0];
  return LW_OK;
}

lw_result describe(const lw_container& container, lw_array array, const ArrayForm*& form, const ChunkInfo*& chunk, lw_array_info& info) {
  form = nullptr;
  for (const ArrayForm& candidate : kForms)
    if (candidate.array == array) form = &candidate;
  if (!form) return container.host.fail(LW_INVALID_ARGUMENT, "%d is not an lw_array", int(array));
  lw_result result = findChunk(container, form->section, form->chunk, chunk);
  if (result) return result;
  if (chunk->element != form->element) return badSection(container, *chunk, "it has another element type than its section demands");
  uint64_t elements = 0;
  if ((result = expectedElements(container, *form, elements))) return result;
  const uint32_t dimensions = (isAtlas(*form) ? 2 : 1) + (form->stored_components > 1 ? 1 : 0);
  if (chunk->rank != dimensions || chunk->elements != elements * form->stored_components ||
      (form->stored_components > 1 && chunk->shape[dimensions - 1] != form->stored_components))
    return badSection(container, *chunk, "its shape contradicts the other chunks of its section");
  const uint64_t bytes = elements * form->components * form->component_bytes;
  if (bytes > SIZE_MAX) return container.host.fail(LW_LIMIT_EXCEEDED, "%s/%s is larger than the address space", form->section, form->chunk);
  info = {elements, form->components, form->component_bytes, size_t(bytes)};
  return LW_OK;
}

/// The stored elements of 4 bytes lie at the end of the destination, whose elements of 12 bytes are written from the front: the writes
/// never pass the reads.
void unpackInPlace(const ArrayForm& form, uint8_t* destination, uint64_t elements) {
  const uint8_t* stored = destination + elements * 8;
  for (uint64_t i = 0; i < elements; ++i) {
    format::Float3 value;
    if (form.unpack == Unpack::octahedral) {
      format::Oct16 oct;
      std::memcpy(&oct, stored + i * 4, sizeof oct);
      value = format::unpackOct(oct);
    } else {
      uint32_t packed;
      std::memcpy(&packed, stored + i * 4, sizeof packed);
      value = format::unpackRgb9e5(packed);
    }
    std::memcpy(destination + i * 12, &value, sizeof value);
  }
}

template <class T>
bool allBelow(const void* values, uint64_t count, uint64_t limit) {
  const T* v = static_cast<const T*>(values);
  bool good = true;
  for (uint64_t i = 0; i < count; ++i) good &= v[i] < limit;
  return good;
}

/// Calls `visit(index, fields of the material)` for each of the container's alpha materials.
template <class Visit>
lw_result readAlphaMaterials(const lw_container& container, Visit visit) {
  const ChunkInfo* chunk = nullptr;
  lw_result result = findChunk(container, "geometry", "alpha_material", chunk);
  if (result) return result;
  if (chunk->element != ElementType::bytes) return badSection(container, *chunk, "it is not a message");
  Array<uint8_t> message;
  if ((result = decodeChunk(container, *chunk, message))) return result;
  format::WireReader list(message.data(), message.size());
  uint32_t index = 0;
  while (list.next()) {
    if (list.field() != 1) continue;
    format::WireReader fields(list.bytes());
    lw_alpha_material material{};
    material.texture = -1;
    uint32_t texture = 0;
    while (fields.next()) switch (fields.field()) {
        case 1: fields.read(material.mode); break;
        case 2: fields.read(material.cutoff); break;
        case 3: fields.read(material.factor); break;
        case 4:
          fields.read(texture);
          material.texture = texture <= uint32_t(INT32_MAX) ? int32_t(texture) : INT32_MAX;
          break;
        case 5: fields.read(material.wrap_u); break;
        case 6: fields.read(material.wrap_v); break;
      }
    const bool textured = material.texture >= 0;
    const bool good = fields.ok() && (material.mode == LW_ALPHA_MASK || material.mode == LW_ALPHA_BLEND) &&
                      std::isfinite(material.cutoff) && std::isfinite(material.factor) &&
                      (!textured || (material.wrap_u - 1 < LW_WRAP_MIRROR && material.wrap_v - 1 < LW_WRAP_MIRROR));
    if (!good) return badSection(container, *chunk, "a material's values are out of range");
    visit(index++, material);
  }
  return list.ok() ? LW_OK : badSection(container, *chunk, "it is not a valid message");
}

lw_result checkValues(const lw_container& container, const ArrayForm& form, const ChunkInfo& chunk, const void* values, uint64_t elements) {
  const uint64_t count = elements * form.components;
  bool good = true;
  switch (form.array) {
    case LW_ARRAY_POSITION: case LW_ARRAY_LIGHTMAP_UV: case LW_ARRAY_ALPHA_UV:
      good = allFinite(static_cast<const float*>(values), count);
      break;
    case LW_ARRAY_INDEX: {
      const ChunkInfo* position = nullptr;
      if (const lw_result result = findChunk(container, "geometry", "position", ElementType::f32, position)) return result;
      good = allBelow<uint32_t>(values, count, position->elements / 3);
      break;
    }
    case LW_ARRAY_TRIANGLE_FLAGS: good = allBelow<uint8_t>(values, count, 8); break;
    case LW_ARRAY_TRIANGLE_ALPHA: {
      uint32_t materials = 0;
      if (const lw_result result = readAlphaMaterials(container, [&](uint32_t, const lw_alpha_material&) { ++materials; })) return result;
      const auto* v = static_cast<const uint16_t*>(values);
      for (uint64_t i = 0; i < count; ++i) good &= v[i] == 0xffff || v[i] < materials;
      break;
    }
    case LW_ARRAY_ATLAS_SOURCE: good = isSourceMap(static_cast<const uint32_t*>(values), count); break;
    case LW_ARRAY_ATLAS_COVERAGE: good = allBelow<uint8_t>(values, count, 2); break;
    case LW_ARRAY_NORMAL: case LW_ARRAY_ATLAS_ALBEDO: case LW_ARRAY_ATLAS_EMISSION: break;  // every value is sound
  }
  return good ? LW_OK : badSection(container, chunk, "a value is out of range");
}

lw_result findAlphaTexture(const lw_container& container, uint32_t texture, const ChunkInfo*& chunk) {
  char name[32];
  std::snprintf(name, sizeof name, "alpha_texture_%u", texture);
  if (const lw_result result = findChunk(container, "geometry", name, chunk)) return result;
  if (chunk->element != ElementType::u8 || chunk->rank != 2 || !chunk->elements || chunk->shape[0] > INT32_MAX ||
      chunk->shape[1] > INT32_MAX)
    return badSection(container, *chunk, "it is not a picture of u8[height, width]");
  return LW_OK;
}

lw_result addTextureSize(const lw_container& container, lw_alpha_material& material) {
  if (material.texture < 0) return LW_OK;
  const ChunkInfo* chunk = nullptr;
  const lw_result result = findAlphaTexture(container, uint32_t(material.texture), chunk);
  if (result) return result == LW_NOT_FOUND ? LW_BAD_SECTION : result;  // the material promises it
  material.texture_height = uint32_t(chunk->shape[0]);
  material.texture_width = uint32_t(chunk->shape[1]);
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_get_array_info(const lw_container* container, lw_array array, lw_array_info* info) {
  if (!container || !info) return LW_INVALID_ARGUMENT;
  const ArrayForm* form = nullptr;
  const lightwell::format::ChunkInfo* chunk = nullptr;
  return describe(*container, array, form, chunk, *info);
}

lw_result lw_decode_array(const lw_container* container, lw_array array, void* destination, size_t bytes) {
  if (!container || (!destination && bytes)) return LW_INVALID_ARGUMENT;
  const ArrayForm* form = nullptr;
  const lightwell::format::ChunkInfo* chunk = nullptr;
  lw_array_info info{};
  if (const lw_result result = describe(*container, array, form, chunk, info)) return result;
  if (bytes != info.bytes)
    return container->host.fail(LW_INVALID_ARGUMENT, "%s/%s needs %zu bytes, not %zu", form->section, form->chunk, info.bytes, bytes);
  auto* target = static_cast<uint8_t*>(destination);
  const size_t stored_bytes = size_t(chunk->raw_bytes);
  if (const lightwell::format::Fault fault = container->view.decode(*chunk, target + (bytes - stored_bytes), stored_bytes))
    return container->host.fail(fault);
  if (form->unpack != Unpack::none) unpackInPlace(*form, target, info.elements);
  return checkValues(*container, *form, *chunk, destination, info.elements);
}

lw_result lw_get_alpha_material(const lw_container* container, uint32_t index, lw_alpha_material* out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  bool found = false;
  lw_alpha_material material{};
  lw_result result = readAlphaMaterials(*container, [&](uint32_t i, const lw_alpha_material& m) {
    if (i != index) return;
    material = m;
    found = true;
  });
  if (result) return result;
  if (!found) return container->host.fail(LW_NOT_FOUND, "the container has no alpha material %u", index);
  if ((result = addTextureSize(*container, material))) return result;
  *out = material;
  return LW_OK;
}

lw_result lw_get_alpha_materials(const lw_container* container, uint32_t count, lw_alpha_material* materials) {
  if (!container || (count && !materials)) return LW_INVALID_ARGUMENT;
  uint32_t found = 0;
  lw_result result = readAlphaMaterials(*container, [&](uint32_t i, const lw_alpha_material& material) {
    if (i < count) materials[found++] = material;
  });
  if (result) return result;
  if (found < count) return container->host.fail(LW_NOT_FOUND, "the container has %u alpha materials, not %u", found, count);
  for (uint32_t i = 0; i < count && !result; ++i) result = addTextureSize(*container, materials[i]);
  return result;
}

lw_result lw_decode_alpha_texture(const lw_container* container, uint32_t texture, void* destination, size_t bytes) {
  if (!container || !destination) return LW_INVALID_ARGUMENT;
  const lightwell::format::ChunkInfo* chunk = nullptr;
  if (const lw_result result = findAlphaTexture(*container, texture, chunk)) return result;
  if (bytes != chunk->raw_bytes)
    return container->host.fail(LW_INVALID_ARGUMENT, "alpha texture %u needs %llu bytes, not %zu", texture,
                                static_cast<unsigned long long>(chunk->raw_bytes), bytes);
  if (const lightwell::format::Fault fault = container->view.decode(*chunk, destination, bytes)) return container->host.fail(fault);
  return LW_OK;
}
