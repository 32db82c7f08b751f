#include "tests/format/lightmap_content.h"

#include "format/decode/pixel.h"

namespace lightwell::format {

LightmapContent lightmapContent() {
  LightmapContent c;
  c.base = panesContent();
  c.base.left_out = {"prm"};
  c.base.meta.clear_errors();
  c.header.set_texels(3);
  c.header.set_has_direct(true);
  c.header.set_has_indirect(true);
  c.texel = {0, 1, 3};
  c.direct = {packRgb9e5({4, 2, 1}), 0, packRgb9e5({0.5f, 0.5f, 0.25f})};
  c.indirect = {packRgb9e5({1, 0.5f, 0.25f}), packRgb9e5({2, 1, 1}), 0};
  return c;
}

LightmapContent directionalContent() {
  LightmapContent c = lightmapContent();
  c.header.set_has_direct_gradient(true);
  c.header.set_has_indirect_gradient(true);
  c.direct_gradient = {127, 0, 0, 0, 0, 0, -64, 32, 16};
  c.indirect_gradient = {0, -127, 0, 0, 16, 0, 0, 0, 0};
  return c;
}

Writer toWriter(const LightmapContent& c) {
  Writer writer = toWriter(c.base);
  writer.addSection("lightmap");
  writer.addMessage("lightmap", "header", c.header);
  writer.add("lightmap", "texel", c.texel);
  if (!c.direct.empty()) writer.add("lightmap", "direct", c.direct, {}, ElementType::rgb9e5);
  if (!c.indirect.empty()) writer.add("lightmap", "indirect", c.indirect, {}, ElementType::rgb9e5);
  if (!c.direct_gradient.empty()) writer.add("lightmap", "direct_gradient", c.direct_gradient, {c.direct_gradient.size() / 3, 3});
  if (!c.indirect_gradient.empty()) writer.add("lightmap", "indirect_gradient", c.indirect_gradient, {c.indirect_gradient.size() / 3, 3});
  return writer;
}

}  // namespace lightwell::format
