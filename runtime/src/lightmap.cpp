// Baked light maps: decoding, and what the atlas shows.
#include "runtime/src/lightmap.h"

#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/container.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;
constexpr const char* kSection = "lightmap";

lw_result load(const lw_container& container, lw_lightmap& map) {
  const format::ChunkInfo* chunk = nullptr;
  if (const lw_result result = findChunk(container, kSection, "header", chunk)) return result;
  if (chunk->element != ElementType::bytes) return badSection(container, *chunk, "it is not a message");
  Array<uint8_t> message;
  if (const lw_result result = decodeChunk(container, *chunk, message)) return result;
  if (!format::parseLightmapHeader(message.data(), message.size(), map.header)) return badSection(container, *chunk, "it is not a valid message");
  if (map.header.texels == 0) return badSection(container, *chunk, "it has no texels");

  format::AtlasHeader atlas;
  if (const lw_result result = readAtlasHeader(container, atlas)) return result;
  map.width = atlas.width;
  map.height = atlas.height;
  const uint64_t area = uint64_t(atlas.width) * atlas.height, texels = map.header.texels;
  if (const lw_result result = decodeChunk(container, "atlas", "source", ElementType::u32, area, map.source)) return result;
  if (!isSourceMap(map.source.data(), area)) return container.host.fail(LW_BAD_SECTION, "atlas/source: a texel's source is not its own source");
  if (const lw_result result = decodeChunk(container, kSection, "texel", ElementType::u32, texels, map.texel)) return result;
  for (size_t i = 0; i < texels; ++i)
    if (map.texel[i] >= area || (i > 0 && map.texel[i] <= map.texel[i - 1]))
      return container.host.fail(LW_BAD_SECTION, "lightmap/texel: its texels are not those of the atlas, in order");
  if (map.header.has_direct)
    if (const lw_result result = decodeChunk(container, kSection, "direct", ElementType::rgb9e5, texels, map.direct)) return result;
  if (map.header.has_indirect)
    if (const lw_result result = decodeChunk(container, kSection, "indirect", ElementType::rgb9e5, texels, map.indirect)) return result;
  return LW_OK;
}

void add(const Array<uint32_t>& packed, size_t index, float* rgb) {
  if (packed.empty()) return;
  const auto value = format::unpackRgb9e5(packed[index]);
  rgb[0] += value.x, rgb[1] += value.y, rgb[2] += value.z;
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_lightmap_load(const lw_container* container, lw_lightmap** out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  lw_lightmap* map = createHandle<lw_lightmap>(container->host);
  if (!map) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the light map");
  if (const lw_result result = load(*container, *map)) {
    destroyHandle(map);
    return result;
  }
  *out = map;
  return LW_OK;
}

void lw_lightmap_release(lw_lightmap* map) { destroyHandle(map); }

lw_result lw_lightmap_get_info(const lw_lightmap* map, lw_lightmap_info* info) {
  if (!map || !info) return LW_INVALID_ARGUMENT;
  *info = {map->header.texels, map->width, map->height, map->header.has_direct ? 1u : 0u, map->header.has_indirect ? 1u : 0u};
  return LW_OK;
}

lw_result lw_lightmap_shade(const lw_lightmap* map, const lw_lightmap_shading* given, float* atlas_rgba) {
  if (!map || !atlas_rgba) return LW_INVALID_ARGUMENT;
  const lw_lightmap_shading shading = given ? *given : lw_lightmap_shading LW_LIGHTMAP_SHADING_INIT;
  if (shading.size < sizeof shading || shading.fill > 1 || shading.light > (LW_LIGHTMAP_DIRECT | LW_LIGHTMAP_INDIRECT))
    return map->host.fail(LW_INVALID_ARGUMENT, "lw_lightmap_shading: a value is out of range");
  std::memset(atlas_rgba, 0, map->source.size() * 4 * sizeof(float));
  for (size_t i = 0; i < map->texel.size(); ++i) {
    float* texel = atlas_rgba + size_t(map->texel[i]) * 4;
    if (shading.light & LW_LIGHTMAP_DIRECT) add(map->direct, i, texel);
    if (shading.light & LW_LIGHTMAP_INDIRECT) add(map->indirect, i, texel);
    texel[3] = 1.0f;
  }
  if (shading.fill) fillFromSources(map->source.data(), map->source.size(), atlas_rgba);
  return LW_OK;
}
