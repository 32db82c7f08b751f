// A baked light map as a texture.
#include "runtime/src/gl/context.h"
#include "runtime/src/gl/texture.h"
#include "runtime/src/lightmap.h"

struct lw_gl_lightmap {
  lightwell::runtime::Host host;
  lw_gl* context = nullptr;
  uint64_t texture_bytes = 0;
  lightwell::runtime::gl::Target atlas;
};

namespace lightwell::runtime::gl {
namespace {

lw_result upload(lw_gl_lightmap& out, const lw_lightmap& map, const lw_gl_lightmap_options& options) {
  const Api& api = out.context->api;
  const StateGuard guard(api);
  api.clearErrors();
  const bool full = options.atlas_format == LW_GL_ATLAS_RGBA32F;
  Array<float> rgba;
  if (!rgba.allocate(out.host, size_t(map.width) * map.height * 4)) return out.host.fail(LW_OUT_OF_MEMORY, "no memory for the texels of the light map");
  if (const lw_result result = lw_lightmap_shade(&map, options.shading, rgba.data())) return result;
  // The driver rounds to halves.
  TexelFormat format = full ? kTexelRgba32f : kTexelRgba16f;
  format.type = kFloat;
  api.ActiveTexture(kTexture0);
  out.atlas = {0, 0, int32_t(map.width), int32_t(map.height)};
  out.atlas.texture = createPicture(api, format, out.atlas.width, out.atlas.height, kLinear, rgba.data(), out.texture_bytes);
  if (out.atlas.texture == 0) return out.host.fail(LW_LIMIT_EXCEEDED, "a texture of %u x %u texels is more than this context takes", map.width, map.height);
  return attachTarget(api, out.host, out.atlas);
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_lightmap_create(lw_gl* context, const lw_lightmap* lightmap, const lw_gl_lightmap_options* given, lw_gl_lightmap** out) {
  if (!context || !lightmap || !out) return LW_INVALID_ARGUMENT;
  const lw_gl_lightmap_options options = given ? *given : lw_gl_lightmap_options LW_GL_LIGHTMAP_OPTIONS_INIT;
  if (options.size < sizeof options || options.atlas_format > LW_GL_ATLAS_RGBA32F)
    return context->host.fail(LW_INVALID_ARGUMENT, "lw_gl_lightmap_options: a value is out of range");
  lw_gl_lightmap* map = createHandle<lw_gl_lightmap>(context->host);
  if (!map) return context->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the light map");
  map->context = context;
  if (const lw_result result = gl::upload(*map, *lightmap, options)) {
    lw_gl_lightmap_destroy(map);
    return result;
  }
  *out = map;
  return LW_OK;
}

void lw_gl_lightmap_destroy(lw_gl_lightmap* map) {
  if (!map) return;
  gl::destroyTarget(map->context->api, map->atlas);
  destroyHandle(map);
}

uint32_t lw_gl_lightmap_texture(const lw_gl_lightmap* map) { return map ? map->atlas.texture : 0; }

uint64_t lw_gl_lightmap_texture_bytes(const lw_gl_lightmap* map) { return map ? map->texture_bytes : 0; }

lw_result lw_gl_lightmap_read(lw_gl_lightmap* map, float* rgba) {
  return map && rgba ? gl::readTarget(map->context->api, map->host, map->atlas, rgba) : LW_INVALID_ARGUMENT;
}
