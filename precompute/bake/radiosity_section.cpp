#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"
#include "precompute/bake/sections.h"

namespace lightwell::bake {

namespace {

void addPortals(const scene::Scene& scene, v1::RadiosityHeader& header) {
  uint32_t gates = 0;
  for (const scene::Portal& portal : scene.portals) {
    v1::RadiosityPortal* out = header.add_portals();
    out->set_name(portal.name);
    out->set_first_gate(gates);
    out->set_strips(portal.strips);
    out->set_first_triangle(portal.first_triangle);
    out->set_triangles(portal.triangle_count);
    for (int i = 0; i < 3; ++i) out->add_axis(float(portal.axis[i] / scene.metres_per_unit));
    out->set_offset(portal.offset);
    gates += portal.strips;
  }
}

}  // namespace

void addRadiositySection(format::Writer& writer, const transport::RadiosityResult& radiosity, const scene::Scene& scene) {
  const transport::Patches& patches = radiosity.patches;
  const uint64_t count = patches.count(), texels = radiosity.texel.size();
  const double metres = scene.metres_per_unit;
  v1::RadiosityHeader header;
  header.set_patches(patches.count());
  header.set_texels(uint32_t(texels));
  header.set_has_backs(!radiosity.texel_back_patch.empty());
  header.set_raw_transfers(radiosity.raw_transfers);
  header.set_dark_patches(radiosity.dark_patches);
  for (const auto& material : scene.materials) header.add_materials()->set_name(material.name);
  addPortals(scene, header);
  std::vector<float> area, position, albedo;
  std::vector<int16_t> normal;
  std::vector<uint16_t> material;
  std::vector<uint32_t> emission;
  bool emits = false;
  for (uint32_t i = 0; i < count; ++i) {
    area.push_back(float(patches.area[i] * metres * metres));
    for (int c = 0; c < 3; ++c) {
      position.push_back(float(patches.position[i][c] * metres));
      albedo.push_back(patches.albedo_rgb[i][c]);
    }
    const auto oct = format::packOct({patches.normal[i].x, patches.normal[i].y, patches.normal[i].z});
    normal.push_back(oct.x);
    normal.push_back(oct.y);
    material.push_back(uint16_t(patches.material[i]));
    const Rgb& emitted = patches.emitted_radiance_rgb[i];
    emission.push_back(format::packRgb9e5({emitted.x, emitted.y, emitted.z}));
    emits |= emission.back() != 0;
  }
  header.set_has_emission(emits);
  std::vector<uint8_t> weight, exposed;
  std::vector<uint32_t> texel_patch;
  for (uint64_t i = 0; i < texels; ++i) {
    exposed.push_back(uint8_t(std::lround(radiosity.texel_exposed[i] * 255.0f)));
    // Rounded weights keep their sum: the first, the texel's own patch, takes what is left.
    int rest = 255;
    for (int k = 3; k >= 0; --k) {
      const int rounded = k == 0 ? rest : std::min(rest, int(std::lround(radiosity.texel_weight[i][size_t(k)] * 255.0f)));
      rest -= rounded;
      weight.push_back(uint8_t(rounded));
    }
    std::reverse(weight.end() - 4, weight.end());
    texel_patch.insert(texel_patch.end(), radiosity.texel_patch[i].begin(), radiosity.texel_patch[i].end());
  }
  writer.addSection("radiosity");
  writer.addMessage("radiosity", "header", header);
  writer.add("radiosity", "patch_area", area);
  writer.add("radiosity", "patch_position", position, {count, 3});
  writer.add("radiosity", "patch_normal", normal, {count, 2});
  writer.add("radiosity", "patch_material", material);
  writer.add("radiosity", "patch_albedo", albedo, {count, 3});
  if (emits) writer.add("radiosity", "patch_emission", emission, {}, format::ElementType::rgb9e5);
  writer.add("radiosity", "link_first", radiosity.links.first);
  writer.add("radiosity", "link_node", radiosity.links.node);
  writer.add("radiosity", "link_code", radiosity.links.code);
  writer.add("radiosity", "row_scale", radiosity.links.row_scale);
  if (!scene.portals.empty()) {
    std::vector<uint16_t> link_gates(radiosity.links.node.size(), 0);
    std::copy(radiosity.links.set.begin(), radiosity.links.set.end(), link_gates.begin());
    writer.add("radiosity", "link_gates", link_gates);
    writer.add("radiosity", "gate_set_first", radiosity.links.sets.first());
    writer.add("radiosity", "gate_set", radiosity.links.sets.entries());
  }
  writer.add("radiosity", "texel", radiosity.texel);
  writer.add("radiosity", "texel_patch", texel_patch, {texels, 4});
  writer.add("radiosity", "texel_weight", weight, {texels, 4});
  writer.add("radiosity", "texel_exposed", exposed);
  if (header.has_backs()) writer.add("radiosity", "texel_back_patch", radiosity.texel_back_patch);
}

}  // namespace lightwell::bake
