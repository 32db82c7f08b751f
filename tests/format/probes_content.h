// A small sound container with a section "probes", as plain data that a test may spoil before it is written.
#pragma once
#include "tests/format/radiosity_content.h"

namespace lightwell::format {

/// portalsContent with three probes on a lattice of 2 × 2 × 2, and one at a point.
struct ProbesContent {
  RadiosityContent base;
  v1::ProbesHeader header;
  std::vector<uint32_t> lattice_point, link_first, link_node, gate_set_first;
  std::vector<int8_t> offset;
  std::vector<uint8_t> nearness, link_code;
  std::vector<float> point_position, scale;
  std::vector<uint16_t> link_gates, gate_set;
  std::set<std::string> left_out;  // chunks that are not written
};

ProbesContent probesContent();
/// The section alone.
void addProbes(Writer& writer, const ProbesContent& content);
Writer toWriter(const ProbesContent& content);

}  // namespace lightwell::format
