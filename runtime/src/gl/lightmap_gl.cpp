// A baked light map as a texture, and another of its gradients.
#include <algorithm>
#include <cmath>

#include "runtime/src/gl/context.h"
#include "runtime/src/gl/shaders.h"
#include "runtime/src/gl/texture.h"
#include "runtime/src/lightmap.h"

struct lw_gl_lightmap {
  lightwell::runtime::Host host;
  lw_gl* context = nullptr;
  uint64_t texture_bytes = 0;
  lightwell::runtime::gl::Target atlas;
  lightwell::runtime::gl::Name gradients = 0;
};

namespace lightwell::runtime::gl {

// 4.0: LW_LIGHTMAP_MOST_GRADIENT.
const char glsl::kLightmap[] = R"(
#ifdef GL_ES
precision highp float;
precision highp sampler2D;
#endif
vec3 lwLightmapIrradiance(sampler2D atlas, sampler2D gradients, vec2 lightmap_uv, vec3 surface_normal, vec3 normal) {
  vec4 gradient = texture(gradients, lightmap_uv);
  vec3 g = gradient.a > 0.0 ? gradient.xyz * (4.0 / gradient.a) : vec3(0.0);
  return lwAtlasIrradiance(atlas, lightmap_uv) * max(0.0, 1.0 + dot(g, normal - surface_normal));
}
)";

namespace {

constexpr float kMostHalf = 65504.0f;

/// `rgba`: the map as it is shown; alpha says which texels have a value.
lw_result uploadGradients(lw_gl_lightmap& out, const lw_lightmap& map, const lw_gl_lightmap_options& options, const Array<float>& rgba) {
  const size_t texels = size_t(map.width) * map.height;
  Array<float> xyz;
  Array<int8_t> packed;
  if (!xyz.allocate(out.host, texels * 3) || !packed.allocate(out.host, texels * 4))
    return out.host.fail(LW_OUT_OF_MEMORY, "no memory for the gradients of the light map");
  if (const lw_result result = lw_lightmap_shade_gradients(&map, options.shading, xyz.data())) return result;
  for (size_t i = 0; i < texels; ++i) {
    for (size_t k = 0; k < 3; ++k) packed[4 * i + k] = int8_t(std::lround(xyz[3 * i + k] * (127.0f / LW_LIGHTMAP_MOST_GRADIENT)));
    packed[4 * i + 3] = rgba[4 * i + 3] > 0.0f ? 127 : 0;
  }
  out.gradients = createPicture(out.context->api, kTexelRgba8Snorm, out.atlas.width, out.atlas.height, kLinear, packed.data(), out.texture_bytes);
  return LW_OK;
}

lw_result upload(lw_gl_lightmap& out, const lw_lightmap& map, const lw_gl_lightmap_options& options) {
  const Api& api = out.context->api;
  const StateGuard guard(api);
  api.clearErrors();
  const bool full = options.atlas_format == LW_GL_ATLAS_RGBA32F;
  Array<float> rgba;
  if (!rgba.allocate(out.host, size_t(map.width) * map.height * 4)) return out.host.fail(LW_OUT_OF_MEMORY, "no memory for the texels of the light map");
  if (const lw_result result = lw_lightmap_shade(&map, options.shading, rgba.data())) return result;
  if (!full) {
    const float most = *std::max_element(rgba.data(), rgba.data() + rgba.size());
    if (most > kMostHalf) return out.host.fail(LW_LIMIT_EXCEEDED, "an irradiance of %g is more than half floats hold: LW_GL_ATLAS_RGBA32F does", double(most));
  }
  // The driver rounds to halves.
  TexelFormat format = full ? kTexelRgba32f : kTexelRgba16f;
  format.type = kFloat;
  api.ActiveTexture(kTexture0);
  out.atlas = {0, 0, int32_t(map.width), int32_t(map.height)};
  out.atlas.texture = createPicture(api, format, out.atlas.width, out.atlas.height, kLinear, rgba.data(), out.texture_bytes);
  if (out.atlas.texture == 0) return out.host.fail(LW_LIMIT_EXCEEDED, "a texture of %u x %u texels is more than this context takes", map.width, map.height);
  if (const lw_result result = attachTarget(api, out.host, out.atlas)) return result;
  return map.header.has_direct_gradient || map.header.has_indirect_gradient ? uploadGradients(out, map, options, rgba) : LW_OK;
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
  if (map->gradients) map->context->api.DeleteTextures(1, &map->gradients);
  destroyHandle(map);
}

uint32_t lw_gl_lightmap_texture(const lw_gl_lightmap* map) { return map ? map->atlas.texture : 0; }

uint32_t lw_gl_lightmap_gradient_texture(const lw_gl_lightmap* map) { return map ? map->gradients : 0; }

uint64_t lw_gl_lightmap_texture_bytes(const lw_gl_lightmap* map) { return map ? map->texture_bytes : 0; }

lw_result lw_gl_lightmap_read(lw_gl_lightmap* map, float* rgba) {
  return map && rgba ? gl::readTarget(map->context->api, map->host, map->atlas, rgba) : LW_INVALID_ARGUMENT;
}
