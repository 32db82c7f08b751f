#include "format/decode/pixel.h"
#include "precompute/bake/sections.h"

namespace lightwell::bake {
namespace {

/// Shared exponents; empty when all values are zero.
std::vector<uint32_t> packed(std::span<const Rgb> values_rgb) {
  std::vector<uint32_t> result;
  bool lit = false;
  for (const Rgb& value : values_rgb) {
    result.push_back(format::packRgb9e5({value.x, value.y, value.z}));
    lit |= result.back() != 0;
  }
  if (!lit) result.clear();
  return result;
}

}  // namespace

void addLightmapSection(format::Writer& writer, const transport::Lightmap& lightmap, const atlas::Atlas& atlas) {
  const auto direct = packed(lightmap.direct_rgb), indirect = packed(lightmap.indirect_rgb);
  v1::LightmapHeader header;
  header.set_texels(uint32_t(atlas.slots.size()));
  header.set_has_direct(!direct.empty());
  header.set_has_indirect(!indirect.empty());
  std::vector<uint32_t> texel;
  for (const auto& slot : atlas.slots) texel.push_back(slot.texel);
  writer.addSection("lightmap");
  writer.addMessage("lightmap", "header", header);
  writer.add("lightmap", "texel", texel);
  if (header.has_direct()) writer.add("lightmap", "direct", direct, {}, format::ElementType::rgb9e5);
  if (header.has_indirect()) writer.add("lightmap", "indirect", indirect, {}, format::ElementType::rgb9e5);
}

}  // namespace lightwell::bake
