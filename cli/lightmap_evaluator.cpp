#include "cli/lightmap_evaluator.h"

#include "cli/gl_context.h"

namespace lightwell::cli {
namespace {

struct Release {
  void operator()(lw_lightmap* map) const { lw_lightmap_release(map); }
  void operator()(lw_gl_lightmap* map) const { lw_gl_lightmap_destroy(map); }
};
using LightmapHandle = std::unique_ptr<lw_lightmap, Release>;

LightmapHandle load(const RuntimeContainer& container, lw_lightmap_info& info) {
  lw_lightmap* raw = nullptr;
  container.check(lw_lightmap_load(container.get(), &raw));
  LightmapHandle map(raw);
  container.check(lw_lightmap_get_info(map.get(), &info));
  return map;
}

lw_lightmap_shading shadingOf(uint32_t light) {
  lw_lightmap_shading shading = LW_LIGHTMAP_SHADING_INIT;
  shading.light = light;
  shading.fill = 0;
  return shading;
}

}  // namespace

std::vector<float> evaluateLightmapOnCpu(const RuntimeContainer& container, uint32_t light) {
  lw_lightmap_info info;
  const auto map = load(container, info);
  const lw_lightmap_shading shading = shadingOf(light);
  std::vector<float> atlas_rgba(size_t(info.width) * info.height * 4);
  container.check(lw_lightmap_shade(map.get(), &shading, atlas_rgba.data()));
  return atlas_rgba;
}

std::vector<float> evaluateLightmapOnGl(const RuntimeContainer& container, uint32_t light) {
  lw_lightmap_info info;
  const auto map = load(container, info);
  const lw_lightmap_shading shading = shadingOf(light);
  const GlContext gl(container);
  lw_gl_lightmap_options options = LW_GL_LIGHTMAP_OPTIONS_INIT;
  options.shading = &shading;
  options.atlas_format = LW_GL_ATLAS_RGBA32F;  // an EXR holds 32-bit floats; a game is served by the half of it
  lw_gl_lightmap* raw = nullptr;
  container.check(lw_gl_lightmap_create(gl.get(), map.get(), &options, &raw));
  const std::unique_ptr<lw_gl_lightmap, Release> texture(raw);
  std::vector<float> atlas_rgba(size_t(info.width) * info.height * 4);
  container.check(lw_gl_lightmap_read(texture.get(), atlas_rgba.data()));
  return atlas_rgba;
}

}  // namespace lightwell::cli
