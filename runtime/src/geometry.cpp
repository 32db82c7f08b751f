#include "runtime/src/geometry.h"

#include <algorithm>

namespace lightwell::runtime {

lw_result loadAlpha(const lw_container* container, const Array<uint8_t>& flags, AlphaSurfaces& alpha) {
  bool any = false;
  for (const uint8_t f : flags) any |= (f & (LW_TRIANGLE_CUT_OUT | LW_TRIANGLE_BLEND)) != 0;
  if (!any) return LW_OK;
  lw_result result = decodeArray(container, LW_ARRAY_ALPHA_UV, alpha.uv);
  if (!result) result = decodeArray(container, LW_ARRAY_TRIANGLE_ALPHA, alpha.triangle_material);
  if (result) return result;
  size_t materials = 0, bytes = 0;
  for (const uint16_t m : alpha.triangle_material)
    if (m != 0xffff) materials = std::max(materials, size_t(m) + 1);
  Array<uint32_t> by_texture;  // materials that share a texture, one after the other: each texture is there once
  if (!alpha.material.allocate(container->host, materials) || !alpha.first_alpha.allocate(container->host, materials) || !by_texture.allocate(container->host, materials))
    return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu materials", materials);
  if ((result = lw_get_alpha_materials(container, uint32_t(materials), alpha.material.data()))) return result == LW_NOT_FOUND ? LW_BAD_SECTION : result;
  for (size_t m = 0; m < materials; ++m) by_texture[m] = uint32_t(m);
  std::sort(by_texture.begin(), by_texture.end(), [&](uint32_t a, uint32_t b) { return alpha.material[a].texture < alpha.material[b].texture; });
  const auto forEachTexture = [&](auto visit) {
    const lw_alpha_material* before = nullptr;
    size_t first = 0;
    for (const uint32_t m : by_texture) {
      const lw_alpha_material& surface = alpha.material[m];
      const bool fresh = surface.texture >= 0 && (!before || before->texture != surface.texture);
      if (before && fresh) first += size_t(before->texture_width) * before->texture_height;
      alpha.first_alpha[m] = first;
      before = &surface;
      if (fresh) visit(surface, first);
    }
  };
  forEachTexture([&](const lw_alpha_material& surface, size_t first) { bytes = first + size_t(surface.texture_width) * surface.texture_height; });
  if (!alpha.alpha.allocate(container->host, bytes)) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu bytes of textures", bytes);
  forEachTexture([&](const lw_alpha_material& surface, size_t first) {
    const size_t texels = size_t(surface.texture_width) * surface.texture_height;
    if (!result) result = texels ? lw_decode_alpha_texture(container, uint32_t(surface.texture), &alpha.alpha[first], texels)
                                 : container->host.fail(LW_BAD_SECTION, "geometry: an alpha texture is empty");
  });
  return result;
}

}  // namespace lightwell::runtime
