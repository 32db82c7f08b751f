// One depth map for each cell of a sky, in one atlas; the most important and oldest are drawn anew first.
#include <algorithm>
#include <cmath>

#include "runtime/src/frame.h"
#include "runtime/src/gl/environment_gl.h"
#include "runtime/src/light.h"

namespace lightwell::runtime::gl {
namespace {

constexpr float kFarthest_m = 1e12f;

/// Orthographic, seen from the sky: the bounds fill the map up to its margin, near is where the light comes from.
void mapMatrix(const lw_gl_environment& environment, const float* direction, int32_t texels, float* matrix) {
  const EnvironmentBlock& block = environment.block;
  float axis[3][3];
  frameAbout(direction, axis[0], axis[1]);
  for (int k = 0; k < 3; ++k) axis[2][k] = -direction[k];
  const float picture = float(texels - 2 * kMapMargin) / float(texels);
  for (int row = 0; row < 3; ++row) {
    float half = 0, center = 0;
    for (int k = 0; k < 3; ++k) {
      half += std::fabs(axis[row][k]) * block.extent_m[k];
      center += axis[row][k] * block.center_m[k];
    }
    const float scale = (row < 2 ? picture : 1.0f) / std::max(half, block.least_extent_m);
    for (int k = 0; k < 3; ++k) matrix[k * 4 + row] = axis[row][k] * scale;
    matrix[12 + row] = -center * scale;
  }
  for (int column = 0; column < 4; ++column) matrix[column * 4 + 3] = column == 3 ? 1.0f : 0.0f;
}

/// Whether map `a` is to be drawn before map `b`.
bool isMoreUrgent(const DepthMapAge& a, const DepthMapAge& b) {
  if (a.drawn != b.drawn) return !a.drawn;
  return a.drawn ? double(a.power) * a.calls > double(b.power) * b.calls : a.power > b.power;
}

void drawMap(const lw_gl_environment& environment, uint32_t cell, lw_gl_draw_casters draw, void* user) {
  const Api& api = environment.context->api;
  const MapPlace place = mapPlace(environment, cell);
  const int32_t side = place.texels;
  constexpr float kFar = 1;
  // Set for each map: the callback may have left them otherwise.
  api.BindFramebuffer(kDrawFramebuffer, environment.framebuffer);
  api.Viewport(place.x, place.y, side, side);
  api.Enable(kScissorTest);
  api.Scissor(place.x, place.y, side, side);
  api.Enable(kDepthTest);
  api.DepthFunc(kLequal);
  api.DepthMask(1);
  api.Disable(kStencilTest);
  api.Disable(kPolygonOffsetFill);
  api.Disable(kCullFace);
  api.ClearBufferfv(kDepth, 0, &kFar);
  api.Scissor(place.x + kMapMargin, place.y + kMapMargin, side - 2 * kMapMargin, side - 2 * kMapMargin);
  float matrix[16];
  mapMatrix(environment, &environment.direction[size_t(cell) * 3], side, matrix);
  draw(user, cell, matrix);
}

}  // namespace

MapPlace mapPlace(const lw_gl_environment& environment, uint32_t cell) {
  const EnvironmentBlock& block = environment.block;
  const bool is_sun = int32_t(cell) < block.suns;
  const EnvironmentBlock::Maps& maps = is_sun ? block.sun_maps : block.cell_maps;
  const int32_t number = is_sun ? int32_t(cell) : int32_t(cell) - block.suns;
  return {number % maps.in_row * maps.texels, number / maps.in_row * maps.texels + maps.first_row, maps.texels};
}

void clearDepthMaps(lw_gl_environment& environment) {
  const Api& api = environment.context->api;
  const DepthStateGuard guard(api);
  constexpr float kFar = 1;
  api.BindFramebuffer(kDrawFramebuffer, environment.framebuffer);
  api.DepthMask(1);
  api.ClearBufferfv(kDepth, 0, &kFar);
  for (DepthMapAge& age : environment.age) age.drawn = false, age.calls = 0;
}

const char* setBounds(lw_gl_environment& environment, const float* bounds_min_m, const float* bounds_max_m) {
  EnvironmentBlock& block = environment.block;
  float largest = 0;
  for (int k = 0; k < 3; ++k) {
    if (!(std::fabs(bounds_min_m[k]) <= kFarthest_m && std::fabs(bounds_max_m[k]) <= kFarthest_m)) return "a value is out of range";
    if (bounds_min_m[k] > bounds_max_m[k]) return "the smallest is beyond the largest";
    largest = std::max(largest, bounds_max_m[k] - bounds_min_m[k]);
  }
  for (int k = 0; k < 3; ++k) {
    block.center_m[k] = 0.5f * (bounds_min_m[k] + bounds_max_m[k]);
    block.extent_m[k] = 0.5f * (bounds_max_m[k] - bounds_min_m[k]) + 1e-3f * largest;  // surfaces in the bounds' faces are not cut off
  }
  block.least_extent_m = std::max(2e-3f * largest, 1e-6f);
  return nullptr;
}

}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;
using namespace lightwell::runtime::gl;

lw_result lw_gl_environment_set_bounds(lw_gl_environment* environment, const float bounds_min_m[3], const float bounds_max_m[3]) {
  if (!environment || !bounds_min_m || !bounds_max_m) return LW_INVALID_ARGUMENT;
  if (const char* reason = setBounds(*environment, bounds_min_m, bounds_max_m))
    return environment->host.fail(LW_INVALID_ARGUMENT, "bounds: %s", reason);
  const StateGuard guard(environment->context->api);
  const BufferGuard buffer_guard(environment->context->api);
  uploadBlock(*environment);
  clearDepthMaps(*environment);
  return LW_OK;
}

lw_result lw_gl_environment_refresh(lw_gl_environment* environment, uint32_t most_maps, lw_gl_draw_casters draw, void* user,
                                    uint32_t* refreshed) {
  if (!environment || !draw) return LW_INVALID_ARGUMENT;
  const StateGuard guard(environment->context->api);
  const DepthStateGuard depth_guard(environment->context->api);
  for (DepthMapAge& age : environment->age) age.calls += age.calls < UINT32_MAX;
  const uint32_t count = std::min(most_maps, environment->cells);
  for (uint32_t n = 0; n < count; ++n) {
    uint32_t chosen = 0;
    for (uint32_t i = 1; i < environment->cells; ++i)
      if (isMoreUrgent(environment->age[i], environment->age[chosen])) chosen = i;
    drawMap(*environment, chosen, draw, user);
    environment->age[chosen].drawn = true;
    environment->age[chosen].calls = 0;
  }
  if (refreshed) *refreshed = count;
  return LW_OK;
}
