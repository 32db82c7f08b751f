#include "tests/format/radiosity_content.h"

#include "format/decode/pixel.h"

namespace lightwell::format {
namespace {

constexpr uint32_t kPatches = 9, kNone = 0xffffffffu;

}  // namespace

RadiosityContent radiosityContent() {
  RadiosityContent c;
  c.base = panesContent();
  c.base.left_out = {"prm"};
  c.base.meta.clear_errors();
  c.header.set_patches(kPatches);
  c.header.set_texels(3);
  c.header.set_has_emission(true);
  c.header.add_materials()->set_name("paint");
  c.header.add_materials()->set_name("lamp");
  c.link_first = {0};
  for (uint32_t i = 0; i < kPatches; ++i) {
    const float place = 0.1f * float(i);
    c.patch_area.push_back(i < 8 ? 0.125f : 0.0625f);
    c.patch_position.insert(c.patch_position.end(), {place, 0, place});
    c.patch_normal.insert(c.patch_normal.end(), {0, 32767});
    c.patch_material.push_back(i == 1 ? 1 : 0);
    c.patch_albedo.insert(c.patch_albedo.end(), {0.5f, 0.25f, 0.125f});
    c.patch_emission.push_back(i == 1 ? packRgb9e5({4, 2, 1}) : 0);
    // From the patch before it, and from all but the last, or from the last alone.
    const uint32_t other = (i + kPatches - 1) % kPatches, node = i % 2 == 0 ? 9 : 10;
    c.link_node.insert(c.link_node.end(), {other, node});
    c.link_code.insert(c.link_code.end(), {uint8_t(0x48), uint8_t(0x30)});  // 24 << 4, 16 << 3
    c.row_scale.push_back(1.0f / 512);
    c.link_first.push_back(uint32_t(c.link_node.size()));
  }
  c.texel = {0, 1, 2};
  c.texel_patch = {0, 1, kNone, kNone, 1, 2, 3, 4, 8, kNone, kNone, kNone};
  c.texel_weight = {200, 55, 0, 0, 64, 64, 64, 63, 255, 0, 0, 0};
  c.texel_exposed = {255, 128, 255};
  return c;
}

RadiosityContent portalsContent() {
  RadiosityContent c = radiosityContent();
  c.header.set_has_backs(true);
  c.texel_back_patch = {kNone, 5, kNone};
  v1::RadiosityPortal& door = *c.header.add_portals();
  door.set_name("door");
  door.set_first_gate(0);
  door.set_strips(2);
  door.set_first_triangle(1);
  door.set_triangles(1);
  for (const float a : {0.5f, 0.0f, 0.0f}) door.add_axis(a);
  door.set_offset(0.25f);
  // Patch 0 sees patch 8 always, node 9 through the first strip, patch 3 on it when it is closed.
  c.link_node = {8, 9, 3};
  c.link_code = {0x48, 0x30, 0x30};
  c.link_gates = {0, 1, 2};
  c.link_first = {0, 3};
  for (uint32_t i = 1; i < kPatches; ++i) {
    c.link_node.push_back(i - 1);
    c.link_code.push_back(0x50);
    c.link_gates.push_back(0);
    c.link_first.push_back(uint32_t(c.link_node.size()));
  }
  c.gate_set_first = {0, 0, 1, 2, 4};
  c.gate_set = {0, 1, 0, 3};
  return c;
}

Writer toWriter(const RadiosityContent& c) {
  Writer writer = toWriter(c.base);
  const auto array = [&]<class T>(const char* name, const std::vector<T>& values, std::initializer_list<uint64_t> shape = {},
                                  ElementType element = detail::elementTypeOf<T>()) {
    if (!c.left_out.contains(name)) writer.add("radiosity", name, values, shape, element);
  };
  writer.addSection("radiosity", 1, true);
  if (!c.left_out.contains("header")) writer.addMessage("radiosity", "header", c.header);
  array("patch_area", c.patch_area);
  array("patch_position", c.patch_position, {c.patch_position.size() / 3, 3});
  array("patch_normal", c.patch_normal, {c.patch_normal.size() / 2, 2});
  array("patch_material", c.patch_material);
  array("patch_albedo", c.patch_albedo, {c.patch_albedo.size() / 3, 3});
  if (!c.patch_emission.empty()) array("patch_emission", c.patch_emission, {}, ElementType::rgb9e5);
  array("link_first", c.link_first);
  array("link_node", c.link_node);
  array("link_code", c.link_code);
  array("row_scale", c.row_scale);
  if (!c.link_gates.empty()) {
    array("link_gates", c.link_gates);
    array("gate_set_first", c.gate_set_first);
    array("gate_set", c.gate_set);
  }
  array("texel", c.texel);
  array("texel_patch", c.texel_patch, {c.texel_patch.size() / 4, 4});
  array("texel_weight", c.texel_weight, {c.texel_weight.size() / 4, 4});
  array("texel_exposed", c.texel_exposed);
  if (!c.texel_back_patch.empty()) array("texel_back_patch", c.texel_back_patch);
  return writer;
}

}  // namespace lightwell::format
