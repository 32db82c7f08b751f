// Baked light maps: decoding, and what the atlas shows.
#include "runtime/src/lightmap.h"

#include <algorithm>
#include <cfloat>
#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/container.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;
constexpr const char* kSection = "lightmap";

lw_result load(const lw_container& container, lw_lightmap& map) {
  if (const lw_result result = readHeader(container, kSection, [&](const Array<uint8_t>& message) {
        return format::parseLightmapHeader(message.data(), message.size(), map.header);
      }))
    return result;
  if (map.header.texels == 0) return container.host.fail(LW_BAD_SECTION, "lightmap/header: it has no texels");
  if (!(map.header.unit >= 0x1p-126f && map.header.unit <= 0x1p126f)) return container.host.fail(LW_BAD_SECTION, "lightmap/header: its unit is out of range");

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
  if (map.header.has_direct_gradient)
    if (const lw_result result = decodeChunk(container, kSection, "direct_gradient", ElementType::i8, 3 * texels, map.direct_gradient)) return result;
  if (map.header.has_indirect_gradient)
    if (const lw_result result = decodeChunk(container, kSection, "indirect_gradient", ElementType::i8, 3 * texels, map.indirect_gradient)) return result;
  return LW_OK;
}

struct Values {
  float v[3] = {0, 0, 0};
};

Values lightAt(const lw_lightmap& map, const Array<uint32_t>& packed, size_t index) {
  if (packed.empty()) return {};
  const auto value = format::unpackRgb9e5(packed[index]);
  const auto scaled = [&](float v) { return std::min(v * map.header.unit, FLT_MAX / 4); };  // two of them are added, and tilted
  return {{scaled(value.x), scaled(value.y), scaled(value.z)}};
}

Values gradientAt(const Array<int8_t>& packed, size_t index) {
  Values gradient;
  for (size_t i = 0; i < 3 && !packed.empty(); ++i)
    gradient.v[i] = (LW_LIGHTMAP_MOST_GRADIENT / 127.0f) * float(packed[3 * index + i] < -127 ? -127 : packed[3 * index + i]);
  return gradient;
}

void add(const lw_lightmap& map, const Array<uint32_t>& packed, size_t index, float* rgb) {
  const Values light = lightAt(map, packed, index);
  for (int c = 0; c < 3; ++c) rgb[c] += light.v[c];
}

/// Irradiance about a normal that differs by `tilt` from the surface's.
void addTilted(const Values& light, const Values& gradient, const float tilt[3], float* rgb) {
  const float factor = std::max(0.0f, 1.0f + gradient.v[0] * tilt[0] + gradient.v[1] * tilt[1] + gradient.v[2] * tilt[2]);
  for (int c = 0; c < 3; ++c) rgb[c] += light.v[c] * factor;
}

float luminance(const Values& rgb) { return 0.2126f * rgb.v[0] + 0.7152f * rgb.v[1] + 0.0722f * rgb.v[2]; }

lw_result readShading(const lw_lightmap& map, const lw_lightmap_shading* given, lw_lightmap_shading& shading) {
  if (given) shading = *given;
  if (shading.size < sizeof shading || shading.fill > 1 || shading.light > (LW_LIGHTMAP_DIRECT | LW_LIGHTMAP_INDIRECT))
    return map.host.fail(LW_INVALID_ARGUMENT, "lw_lightmap_shading: a value is out of range");
  return LW_OK;
}

/// Each texel gets the vector of its source.
void fillFromSources(const lw_lightmap& map, float* atlas_xyz) {
  for (size_t i = 0; i < map.source.size(); ++i)
    if (const uint32_t source = map.source[i]; source != kNone && source != i) std::memcpy(atlas_xyz + 3 * i, atlas_xyz + 3 * size_t(source), 3 * sizeof(float));
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
  *info = {map->header.texels, map->width, map->height, map->header.has_direct ? 1u : 0u, map->header.has_indirect ? 1u : 0u,
           map->header.has_direct_gradient || map->header.has_indirect_gradient ? 1u : 0u};
  return LW_OK;
}

lw_result lw_lightmap_shade(const lw_lightmap* map, const lw_lightmap_shading* given, float* atlas_rgba) {
  if (!map || !atlas_rgba) return LW_INVALID_ARGUMENT;
  lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
  if (const lw_result result = readShading(*map, given, shading)) return result;
  std::memset(atlas_rgba, 0, map->source.size() * 4 * sizeof(float));
  for (size_t i = 0; i < map->texel.size(); ++i) {
    float* texel = atlas_rgba + size_t(map->texel[i]) * 4;
    if (shading.light & LW_LIGHTMAP_DIRECT) add(*map, map->direct, i, texel);
    if (shading.light & LW_LIGHTMAP_INDIRECT) add(*map, map->indirect, i, texel);
    texel[3] = 1.0f;
  }
  if (shading.fill) fillFromSources(map->source.data(), map->source.size(), atlas_rgba);
  return LW_OK;
}

lw_result lw_lightmap_shade_gradients(const lw_lightmap* map, const lw_lightmap_shading* given, float* atlas_xyz) {
  if (!map || !atlas_xyz) return LW_INVALID_ARGUMENT;
  lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
  if (const lw_result result = readShading(*map, given, shading)) return result;
  std::memset(atlas_xyz, 0, map->source.size() * 3 * sizeof(float));
  for (size_t i = 0; i < map->texel.size(); ++i) {
    const float direct = shading.light & LW_LIGHTMAP_DIRECT ? luminance(lightAt(*map, map->direct, i)) : 0.0f;
    const float indirect = shading.light & LW_LIGHTMAP_INDIRECT ? luminance(lightAt(*map, map->indirect, i)) : 0.0f;
    if (!(direct + indirect > 0.0f)) continue;
    const Values a = gradientAt(map->direct_gradient, i), b = gradientAt(map->indirect_gradient, i);
    for (int k = 0; k < 3; ++k) atlas_xyz[3 * size_t(map->texel[i]) + k] = (direct * a.v[k] + indirect * b.v[k]) / (direct + indirect);
  }
  if (shading.fill) fillFromSources(*map, atlas_xyz);
  return LW_OK;
}

lw_result lw_lightmap_irradiance(const lw_lightmap* map, const lw_lightmap_shading* given, uint32_t x, uint32_t y, const float surface_normal[3],
                                 const float normal[3], float rgb[3]) {
  if (!map || !surface_normal || !normal || !rgb) return LW_INVALID_ARGUMENT;
  lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
  if (const lw_result result = readShading(*map, given, shading)) return result;
  if (x >= map->width || y >= map->height)
    return map->host.fail(LW_INVALID_ARGUMENT, "texel (%u, %u) lies outside an atlas of %u x %u texels", x, y, map->width, map->height);
  uint32_t texel = y * map->width + x;
  if (shading.fill) texel = map->source[texel];
  rgb[0] = rgb[1] = rgb[2] = 0.0f;
  const uint32_t* end = map->texel.data() + map->texel.size();
  const uint32_t* found = std::lower_bound(map->texel.data(), end, texel);
  if (found == end || *found != texel) return LW_OK;
  const size_t i = size_t(found - map->texel.data());
  const float tilt[3] = {normal[0] - surface_normal[0], normal[1] - surface_normal[1], normal[2] - surface_normal[2]};
  if (shading.light & LW_LIGHTMAP_DIRECT) addTilted(lightAt(*map, map->direct, i), gradientAt(map->direct_gradient, i), tilt, rgb);
  if (shading.light & LW_LIGHTMAP_INDIRECT) addTilted(lightAt(*map, map->indirect, i), gradientAt(map->indirect_gradient, i), tilt, rgb);
  return LW_OK;
}
