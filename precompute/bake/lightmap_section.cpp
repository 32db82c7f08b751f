#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"
#include "precompute/bake/sections.h"

namespace lightwell::bake {
namespace {

constexpr float kMostGradient = 4;  // docs/format.md

/// Shared exponents reach over twelve decades: 1 where all light fits into them with room below; else the power of two that puts the brightest value near their top.
float unitFor(const transport::Lightmap& lightmap) {
  constexpr float kDimmest = 0x1p-8f;
  float most = 0;
  for (const auto* values_rgb : {&lightmap.direct_rgb, &lightmap.indirect_rgb})
    for (const Rgb& value : *values_rgb) most = std::max(most, maxComponent(value));
  if (!(most > 0) || (most >= kDimmest && most <= format::kRgb9e5Max)) return 1;
  return std::ldexp(1.0f, std::max(std::ilogb(most) - 14, -126));
}

/// Shared exponents; empty when all values are zero.
std::vector<uint32_t> packed(std::span<const Rgb> values_rgb, float unit) {
  std::vector<uint32_t> result;
  bool lit = false;
  for (const Rgb& value : values_rgb) {
    result.push_back(format::packRgb9e5({value.x / unit, value.y / unit, value.z / unit}));
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
  const float unit = unitFor(lightmap);
  const auto direct = packed(lightmap.direct_rgb, unit), indirect = packed(lightmap.indirect_rgb, unit);
  v1::LightmapHeader header;
  if (unit != 1) header.set_unit(unit);
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
