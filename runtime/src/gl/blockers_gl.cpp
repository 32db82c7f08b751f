// Blockers in the game's own shaders: every pixel knows how much of its hemisphere they fill.
#include "runtime/src/blockers.h"
#include "runtime/src/gl/context.h"
#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl::glsl {

const char kBlockers[] = R"(
#ifdef GL_ES
precision highp float;
#endif
#ifndef LW_BLOCKERS
#define LW_BLOCKERS 16
#endif
uniform vec4 lw_blocker_sphere[LW_BLOCKERS];
uniform vec4 lw_blocker_albedo[LW_BLOCKERS];
uniform int lw_blocker_count;
// The cosine-weighted share of the hemisphere about `normal` that a sphere (centre, radius) fills.
float lwBlockedShare(vec3 position_m, vec3 normal, vec4 sphere) {
  vec3 d = sphere.xyz - position_m;
  float square = dot(d, d), radius2 = sphere.w * sphere.w;
  if (square <= radius2) return radius2 > 0.0 ? 1.0 : 0.0;
  float cosine = clamp(dot(d, normal) * inversesqrt(square), -1.0, 1.0), h2 = square / radius2, clipped = 1.0 - h2 * cosine * cosine;
  if (!(h2 < 1e12)) return 0.0;
  if (clipped <= 0.0) return max(cosine, 0.0) / h2;
  float beyond = h2 - 1.0, angle = acos(clamp(-cosine * sqrt(beyond / (1.0 - cosine * cosine)), -1.0, 1.0));
  return clamp(((cosine * angle - sqrt(clipped * beyond)) / h2 + atan(sqrt(clipped), sqrt(beyond))) * 0.31830988618, 0.0, 1.0);
}
// What is left of light from all around.
vec3 lwBlockersKept(vec3 position_m, vec3 normal) {
  float free = 1.0, shares = 0.0;
  vec3 reflected = vec3(0.0);
  for (int i = 0; i < lw_blocker_count && i < LW_BLOCKERS; ++i) {
    float share = lwBlockedShare(position_m, normal, lw_blocker_sphere[i]);
    free *= 1.0 - share;
    shares += share;
    reflected += share * lw_blocker_albedo[i].rgb;
  }
  return vec3(free) + (shares > 0.0 ? (1.0 - free) / shares : 0.0) * reflected;
}
)";

}  // namespace lightwell::runtime::gl::glsl

using namespace lightwell::runtime;

lw_result lw_gl_set_blockers(lw_gl* context, uint32_t program, const lw_blocker* blockers, uint32_t count) {
  if (!context || !program || (!blockers && count > 0)) return LW_INVALID_ARGUMENT;
  for (uint32_t i = 0; i < count; ++i)
    if (const char* wrong = checkBlocker(blockers[i])) return context->host.fail(LW_INVALID_ARGUMENT, "blocker %u: %s", i, wrong);
  const gl::Api& api = context->api;
  const int32_t number = api.GetUniformLocation(program, "lw_blocker_count");
  if (number < 0) return context->host.fail(LW_NOT_FOUND, "the program does not use lwBlockersKept");
  Array<float> values;
  if (!values.allocate(context->host, size_t(count) * 8)) return context->host.fail(LW_OUT_OF_MEMORY, "no memory for %u blockers", count);
  float *sphere = values.data(), *albedo = sphere + size_t(count) * 4;
  for (size_t i = 0; i < count; ++i)
    for (size_t k = 0; k < 4; ++k) {
      sphere[i * 4 + k] = k < 3 ? blockers[i].position_m[k] : blockers[i].radius_m;
      albedo[i * 4 + k] = k < 3 ? blockers[i].albedo_rgb[k] : 0.0f;
    }
  int32_t previous = 0;
  api.GetIntegerv(gl::kCurrentProgram, &previous);
  api.UseProgram(program);
  api.Uniform1i(number, int32_t(count));
  if (count > 0) {
    api.Uniform4fv(api.GetUniformLocation(program, "lw_blocker_sphere"), int32_t(count), sphere);
    api.Uniform4fv(api.GetUniformLocation(program, "lw_blocker_albedo"), int32_t(count), albedo);
  }
  api.UseProgram(gl::Name(previous));
  return LW_OK;
}
