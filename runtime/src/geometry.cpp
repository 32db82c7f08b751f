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
  if (!alpha.material.allocate(container->host, materials) || !alpha.first_alpha.allocate(container->host, materials))
    return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu materials", materials);
  for (size_t m = 0; m < materials; ++m) {
    if ((result = lw_get_alpha_material(container, uint32_t(m), &alpha.material[m]))) return result == LW_NOT_FOUND ? LW_BAD_SECTION : result;
    alpha.first_alpha[m] = bytes;
    bytes += size_t(alpha.material[m].texture_width) * alpha.material[m].texture_height;
  }
  if (!alpha.alpha.allocate(container->host, bytes)) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for %zu bytes of textures", bytes);
  for (size_t m = 0; m < materials; ++m) {
    const lw_alpha_material& surface = alpha.material[m];
    if (surface.texture < 0) continue;
    if (!surface.texture_width || !surface.texture_height) return container->host.fail(LW_BAD_SECTION, "geometry: an alpha texture is empty");
    if ((result = lw_decode_alpha_texture(container, uint32_t(surface.texture), &alpha.alpha[alpha.first_alpha[m]],
                                          size_t(surface.texture_width) * surface.texture_height)))
      return result;
  }
  return LW_OK;
}

}  // namespace lightwell::runtime
