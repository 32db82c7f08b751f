#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"
#include "precompute/bake/sections.h"

namespace lightwell::bake {
namespace {

constexpr float kMostGradient = 4;  // docs/format.md

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

/// Empty without gradients, and when all of them are zero.
std::vector<int8_t> packedGradients(std::span<const Vec3> gradients) {
  std::vector<int8_t> result;
  bool any = false;
  for (const Vec3& gradient : gradients)
    for (int i = 0; i < 3; ++i) {
      result.push_back(int8_t(std::lround(std::clamp(gradient[i] / kMostGradient, -1.0f, 1.0f) * 127.0f)));
      any |= result.back() != 0;
    }
  if (!any) result.clear();
  return result;
}

}  // namespace

void addLightmapSection(format::Writer& writer, const transport::Lightmap& lightmap, const atlas::Atlas& atlas) {
  const auto direct = packed(lightmap.direct_rgb), indirect = packed(lightmap.indirect_rgb);
  v1::LightmapHeader header;
  header.set_texels(uint32_t(atlas.slots.size()));
  header.set_has_direct(!direct.empty());
  header.set_has_indirect(!indirect.empty());
  const auto direct_gradient = packedGradients(lightmap.direct_gradient), indirect_gradient = packedGradients(lightmap.indirect_gradient);
  header.set_has_direct_gradient(header.has_direct() && !direct_gradient.empty());
  header.set_has_indirect_gradient(header.has_indirect() && !indirect_gradient.empty());
  std::vector<uint32_t> texel;
  for (const auto& slot : atlas.slots) texel.push_back(slot.texel);
  writer.addSection("lightmap");
  writer.addMessage("lightmap", "header", header);
  writer.add("lightmap", "texel", texel);
  if (header.has_direct()) writer.add("lightmap", "direct", direct, {}, format::ElementType::rgb9e5);
  if (header.has_indirect()) writer.add("lightmap", "indirect", indirect, {}, format::ElementType::rgb9e5);
  if (header.has_direct_gradient()) writer.add("lightmap", "direct_gradient", direct_gradient, {texel.size(), 3});
  if (header.has_indirect_gradient()) writer.add("lightmap", "indirect_gradient", indirect_gradient, {texel.size(), 3});
}

}  // namespace lightwell::bake
