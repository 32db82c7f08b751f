// A small sound container with a section "vpl", as plain data that a test may spoil before it is written.
#pragma once
#include "tests/format/content.h"

namespace lightwell::format {

/// The surfaces and the scene of Content, with one virtual light of each type.
struct VplContent {
  Content base;  // without prm
  v1::VplHeader header;
  std::vector<uint8_t> type, bounce;
  std::vector<uint32_t> source, first_vertex;
  std::vector<float> position, normal, flux, radius, vertex;
};

VplContent vplContent();
Writer toWriter(const VplContent& content);

}  // namespace lightwell::format
