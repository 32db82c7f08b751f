// A baked light map. docs/format.md gives the meaning of the container's arrays.
#pragma once
#include "format/decode/headers.h"
#include "runtime/src/host.h"

struct lw_lightmap {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lightwell::format::LightmapHeader header;
  uint32_t width = 0, height = 0;       // of the atlas
  Array<uint32_t> source;               // [height * width]; each texel's source is its own source, or none
  Array<uint32_t> texel;                // [texels], ascending
  Array<uint32_t> direct, indirect;     // [texels], RGB9E5 of header.unit; empty: zero
  Array<int8_t> direct_gradient, indirect_gradient;  // [texels][3], of 127 / LW_LIGHTMAP_MOST_GRADIENT; empty: zero
};
