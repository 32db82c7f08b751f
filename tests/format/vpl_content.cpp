#include "tests/format/vpl_content.h"

namespace lightwell::format {

VplContent vplContent() {
  VplContent c;
  c.base = panesContent();
  c.base.left_out = {"prm"};
  c.base.meta.clear_errors();
  c.header.set_lights(4);
  c.header.set_vertices(4);
  c.header.set_sources(uint32_t(c.base.scene.lights_size()) + 1);
  c.header.set_points(100);
  c.type = {1, 2, 3, 4};
  c.bounce = {1, 1, 2, 0};
  c.source = {0, 0, 0, c.header.sources() - 1};
  c.position = {0, 1, 0, 1, 1, 0, 2, 1, 0, 0.5f, 2, 0.5f};
  c.normal = {0, 1, 0, 0, 0, 1, 1, 0, 0, 0, -1, 0};
  c.flux = {1, 1, 1, 2, 1, 0, 0.5f, 0.5f, 0.5f, 4, 4, 4};
  c.radius = {0, 0.5f, 0.25f, 0};
  c.first_vertex = {0, 0, 0, 0, 4};
  c.vertex = {0, 2, 0, 1, 2, 0, 1, 2, 1, 0, 2, 1};  // its front downward
  return c;
}

Writer toWriter(const VplContent& c) {
  Writer writer = toWriter(c.base);
  const auto addRows = [&](const char* name, const std::vector<float>& values) { writer.add("vpl", name, values, {values.size() / 3, 3}); };
  writer.addSection("vpl");
  writer.addMessage("vpl", "header", c.header);
  writer.add("vpl", "type", c.type);
  writer.add("vpl", "source", c.source);
  writer.add("vpl", "bounce", c.bounce);
  addRows("position", c.position);
  addRows("normal", c.normal);
  addRows("flux", c.flux);
  writer.add("vpl", "radius", c.radius);
  writer.add("vpl", "first_vertex", c.first_vertex);
  if (!c.vertex.empty()) addRows("vertex", c.vertex);
  return writer;
}

}  // namespace lightwell::format
