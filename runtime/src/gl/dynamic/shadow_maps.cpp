// Imperfect shadow maps: Ritschel et al., "Imperfect Shadow Maps for Efficient Computation of Indirect Illumination" (SIGGRAPH Asia 2008), section 3.
#include <algorithm>
#include <cmath>

#include "runtime/src/gl/dynamic/dynamic_gl.h"

namespace lightwell::runtime::gl {
namespace {

constexpr Enum kLess = 0x0201, kAlways = 0x0207;

void drawTiles(lw_gl_lamp& lamp, uint32_t count) {
  lamp.scene->gl.api.DrawArrays(kTriangles, 0, int32_t(count * 6));
  ++lamp.draws;
}

/// Binds one level of the maps for drawing, and sets what all programs of maps know.
void useLevel(lw_gl_lamp& lamp, const Program& program, int32_t level) {
  const Api& api = lamp.scene->gl.api;
  const int32_t side = int32_t(lamp.options.shadow_side) >> level;
  const float atlas[4] = {float(side), float(lamp.row), float(side * int32_t(lamp.row)), float(side * int32_t(lamp.rows))};
  api.UseProgram(program.name);
  api.Uniform4fv(program.uniform[0], 1, atlas);
  api.Viewport(0, 0, int32_t(atlas[2]), int32_t(atlas[3]));
}

/// How much farther surface may be at the other side of a texel, relative: a surface at 45 degrees, twice over.
float threshold(const lw_gl_lamp& lamp, int32_t level) { return std::min(4.0f * float(1 << level) / float(lamp.options.shadow_side), 1.0f); }

}  // namespace

uint64_t drawShadowMaps(lw_gl_lamp& lamp, uint32_t count) {
  if (lamp.options.shadow_side == 0 || count == 0) return 0;
  lw_gl_dynamic& scene = *lamp.scene;
  const Api& api = scene.gl.api;
  bindTexture(api, 0, kTexture2d, lamp.request);
  api.BindFramebuffer(kDrawFramebuffer, lamp.shadow_framebuffer);
  api.Enable(kDepthTest);
  api.DepthMask(1);
  useLevel(lamp, scene.clear, 0);
  api.DepthFunc(kAlways);
  drawTiles(lamp, count);
  useLevel(lamp, scene.splat, 0);
  api.DepthFunc(kLess);
  double diagonal = 0;
  for (int k = 0; k < 3; ++k) diagonal += std::pow(double(scene.bounds_max_m[k]) - double(scene.bounds_min_m[k]), 2);
  const float points[4] = {float(scene.points), float(lamp.points_each), scene.points_area_m2 / float(lamp.points_each), float(1 / std::max(std::sqrt(diagonal) * 1.001, 1e-30))};
  api.Uniform4fv(scene.splat.uniform[splat_uniform::points], 1, points);
  bindTexture(api, 1, kTexture2d, lamp.place.texture);
  bindTexture(api, 2, kTexture2dArray, scene.point);
  api.DrawArrays(kPoints, 0, int32_t(count * lamp.points_each));
  ++lamp.draws;
  api.Disable(kDepthTest);
  // Pull: level 0 was splatted.
  for (int32_t level = 1; level < lamp.shadow_levels; ++level) {
    bindTexture(api, 1, kTexture2d, lamp.pulled);
    drawIntoLevel(scene, lamp.pulled, level, level - 1);
    useLevel(lamp, scene.pull, level);
    api.Uniform1f(scene.pull.uniform[tiles_uniform::threshold], threshold(lamp, level));
    drawTiles(lamp, count);
  }
  // Push. The coarsest level is as it was pulled.
  const int32_t coarsest = lamp.shadow_levels - 1;
  for (int32_t level = coarsest - 1; level >= 0; --level) {
    const bool first = level + 1 == coarsest;
    bindTexture(api, 1, kTexture2d, lamp.pulled);
    setLevels(api, level, first ? coarsest : level);
    bindTexture(api, 2, kTexture2d, lamp.pushed);
    drawIntoLevel(scene, lamp.pushed, level, level + 1);
    if (first) bindTexture(api, 2, kTexture2d, lamp.pulled);
    useLevel(lamp, scene.push, level);
    api.Uniform1i(scene.push.uniform[tiles_uniform::level], first ? 1 : 0);
    api.Uniform1f(scene.push.uniform[tiles_uniform::threshold], threshold(lamp, level));
    drawTiles(lamp, count);
  }
  bindTexture(api, 1, kTexture2d, lamp.pushed);
  setLevels(api, 0, 0);
  return uint64_t(count) * lamp.points_each;
}

}  // namespace lightwell::runtime::gl
