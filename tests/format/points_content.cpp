#include "tests/format/points_content.h"

namespace lightwell::format {

PointsContent pointsContent() {
  PointsContent c;
  c.base = panesContent();
  c.base.left_out = {"prm"};
  c.base.meta.clear_errors();
  c.header.set_points(4);
  c.header.set_area(6);
  for (int k = 0; k < 3; ++k) c.header.add_first(-1), c.header.add_step(k == 1 ? 0 : 2.0f / 65535);
  c.position = {0, 0, 0, 65535, 0, 0, 0, 0, 65535, 32768, 0, 32768};
  c.normal = {0, 32767, 0, 32767, 32767, 0, -32767, 0};
  c.texel = {0xffffffffu, 0xffffffffu, 0xffffffffu, 0xffffffffu};
  for (uint32_t t = 0; t < c.base.source.size(); ++t)
    if (c.base.source[t] == t) c.texel[0] = t;
  return c;
}

Writer toWriter(const PointsContent& c) {
  Writer writer = toWriter(c.base);
  writer.addSection("points");
  writer.addMessage("points", "header", c.header);
  writer.add("points", "position", c.position, {c.position.size() / 3, 3});
  writer.add("points", "normal", c.normal, {c.normal.size() / 2, 2});
  writer.add("points", "texel", c.texel);
  return writer;
}

}  // namespace lightwell::format
