// A small sound container with a section "lightmap", as plain data that a test may spoil before it is written.
#pragma once
#include "tests/format/content.h"

namespace lightwell::format {

/// The surfaces and the atlas of Content, with a light map on three of its texels.
struct LightmapContent {
  Content base;  // without prm
  v1::LightmapHeader header;
  std::vector<uint32_t> texel, direct, indirect;  // the latter not written when empty
  std::vector<int8_t> direct_gradient, indirect_gradient;  // likewise
};

LightmapContent lightmapContent();
/// The same with gradients.
LightmapContent directionalContent();
Writer toWriter(const LightmapContent& content);

}  // namespace lightwell::format
