#include "tests/format/probes_content.h"

namespace lightwell::format {

ProbesContent probesContent() {
  ProbesContent c;
  c.base = portalsContent();
  c.header.set_lattice_probes(3);
  c.header.set_points(1);
  for (int k = 0; k < 3; ++k) c.header.add_lattice_count(2), c.header.add_lattice_first(0.25f);
  c.header.set_lattice_spacing(0.5f);
  c.header.set_moved(1);
  c.header.set_inside(5);
  c.lattice_point = {0, 3, 6};
  c.offset = {0, 0, 0, 127, 0, -127, 10, 20, -30};
  for (int i = 0; i < 3 * 289; ++i) c.nearness.push_back(uint8_t(i % 3 == 0 ? 0 : 90 + i % 50));
  c.point_position = {0.5f, 1.5f, 0.25f};
  // Two patches each; the last sees patch 8 through the open door.
  c.link_first = {0};
  for (uint32_t i = 0; i < 4; ++i) {
    c.link_node.insert(c.link_node.end(), {i, i < 3 ? 9u : 8u});
    c.link_code.insert(c.link_code.end(), {uint8_t(0x48), uint8_t(0x30)});  // 24 << 4, 16 << 3
    c.link_gates.insert(c.link_gates.end(), {uint16_t(0), uint16_t(i < 3 ? 0 : 1)});
    c.link_first.push_back(uint32_t(c.link_node.size()));
    c.scale.push_back(1.0f / 512);
  }
  c.gate_set_first = {0, 0, 1};
  c.gate_set = {0};
  return c;
}

void addProbes(Writer& writer, const ProbesContent& c) {
  const auto array = [&]<class T>(const char* name, const std::vector<T>& values, std::initializer_list<uint64_t> shape = {}) {
    if (!c.left_out.contains(name)) writer.add("probes", name, values, shape);
  };
  writer.addSection("probes");
  if (!c.left_out.contains("header")) writer.addMessage("probes", "header", c.header);
  array("lattice_point", c.lattice_point);
  array("offset", c.offset, {c.offset.size() / 3, 3});
  array("nearness", c.nearness, {c.nearness.size() / 289, 289});
  if (!c.point_position.empty()) array("point_position", c.point_position, {c.point_position.size() / 3, 3});
  array("link_first", c.link_first);
  array("link_node", c.link_node);
  array("link_code", c.link_code);
  array("scale", c.scale);
  if (!c.link_gates.empty()) {
    array("link_gates", c.link_gates);
    array("gate_set_first", c.gate_set_first);
    array("gate_set", c.gate_set);
  }
}

Writer toWriter(const ProbesContent& c) {
  Writer writer = toWriter(c.base);
  addProbes(writer, c);
  return writer;
}

}  // namespace lightwell::format
