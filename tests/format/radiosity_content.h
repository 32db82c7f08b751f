// A small sound container with a section "radiosity", as plain data that a test may spoil before it is written.
#pragma once
#include "tests/format/content.h"

namespace lightwell::format {

/// The surfaces and the atlas of Content; nine patches under two nodes (9 and 10) on three texels, of two materials; patch 1 emits.
struct RadiosityContent {
  Content base;  // without prm
  v1::RadiosityHeader header;
  std::vector<float> patch_area, patch_position, patch_albedo, row_scale;
  std::vector<int16_t> patch_normal;
  std::vector<uint16_t> patch_material, link_gates, gate_set;
  std::vector<uint32_t> patch_emission, link_first, link_node, gate_set_first, texel, texel_patch, texel_back_patch;
  std::vector<uint8_t> link_code, texel_weight, texel_exposed;
  std::set<std::string> left_out;  // chunks that are not written
};

RadiosityContent radiosityContent();
/// With backs, and with a portal of two strips between patch 0 and what it receives.
RadiosityContent portalsContent();
Writer toWriter(const RadiosityContent& content);

}  // namespace lightwell::format
