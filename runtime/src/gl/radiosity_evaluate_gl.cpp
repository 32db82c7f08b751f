// Sweeps over the links, and the atlas texture.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/gl/radiosity_gl.h"
#include "runtime/src/gl/shaders.h"

namespace lightwell::runtime::gl {

void drawInto(const lw_gl_radiosity& r, const Target& target, uint32_t begin, uint32_t end) {
  const Api& api = r.context->api;
  const int32_t first_row = int32_t(begin / glsl::kRow), end_row = int32_t((end + glsl::kRow - 1) / glsl::kRow);
  api.BindFramebuffer(kDrawFramebuffer, target.framebuffer);
  api.Viewport(0, first_row, target.width, std::min(end_row, target.height) - first_row);
  api.BindVertexArray(r.context->vertex_array);
  api.DrawArrays(kTriangles, 0, 3);
}

void bind(const Api& api, uint32_t unit, Enum target, Name texture) {
  api.ActiveTexture(kTexture0 + unit);
  api.BindTexture(target, texture);
}

void updateNodes(const lw_gl_radiosity& r, uint32_t light) {
  const lw_gl& context = *r.context;
  const Api& api = context.api;
  const Program& patches = context.radiosity_patches;
  api.UseProgram(patches.name);
  api.Uniform1i(patches.uniform[radiosity_patches_uniform::patches], int32_t(r.patches));
  api.Uniform1i(patches.uniform[radiosity_patches_uniform::light], int32_t(light));
  bind(api, 0, kTexture2dArray, r.albedo);
  bind(api, 1, kTexture2dArray, r.emitted);
  bind(api, 2, kTexture2d, r.direct.texture);
  bind(api, 3, kTexture2d, r.irradiance[r.current].texture);
  bind(api, 4, kTexture2dArray, r.kept);
  drawInto(r, r.node, 0, r.patches);

  // A level is made beside the others and copied to them: a texture must not be read while it is drawn into.
  const Program& nodes = context.radiosity_nodes;
  api.UseProgram(nodes.name);
  bind(api, 1, kTexture2dArray, r.share);
  for (uint32_t k = 1; k < r.levels; ++k) {
    api.Uniform1i(nodes.uniform[radiosity_nodes_uniform::begin], int32_t(r.level_first[k]));
    api.Uniform1i(nodes.uniform[radiosity_nodes_uniform::end], int32_t(r.level_first[k + 1]));
    api.Uniform1i(nodes.uniform[radiosity_nodes_uniform::child_begin], int32_t(r.level_first[k - 1]));
    bind(api, 0, kTexture2d, r.node.texture);
    drawInto(r, r.level, r.level_first[k], r.level_first[k + 1]);
    api.Uniform1i(nodes.uniform[radiosity_nodes_uniform::child_begin], -1);
    bind(api, 0, kTexture2d, r.level.texture);
    drawInto(r, r.node, r.level_first[k], r.level_first[k + 1]);
  }
}

namespace {

/// result = previous + omega · (what patches receive from the nodes − previous).
void gather(const lw_gl_radiosity& r, const Target& previous, const float* omega, const Target& result) {
  const lw_gl& context = *r.context;
  const Api& api = context.api;
  const Program& program = context.radiosity_gather;
  api.UseProgram(program.name);
  api.Uniform1i(program.uniform[radiosity_gather_uniform::patches], int32_t(r.patches));
  api.Uniform4fv(program.uniform[radiosity_gather_uniform::omega], 1, omega);
  bind(api, 0, kTexture2dArray, r.link);
  bind(api, 1, kTexture2dArray, r.row);
  bind(api, 2, kTexture2dArray, r.run);
  bind(api, 3, kTexture2dArray, r.gate);
  bind(api, 4, kTexture2d, r.node.texture);
  bind(api, 5, kTexture2d, previous.texture);
  drawInto(r, result, 0, r.patches);
}

constexpr float kPlain[4] = {1, 1, 1, 1};

void sweep(lw_gl_radiosity& r, const float* omega) {
  updateNodes(r, LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS);
  const uint32_t next = (r.current + 1) % 3, before = (r.current + 2) % 3;
  gather(r, r.irradiance[before], omega, r.irradiance[next]);
  r.current = next;
}

/// By patch, [patches][3].
lw_result readPatches(const lw_gl_radiosity& r, const Target& target, float* rgb) {
  Array<float> rgba;
  if (!rgba.allocate(r.host, size_t(target.width) * size_t(target.height) * 4)) return r.host.fail(LW_OUT_OF_MEMORY, "no memory to read back %u values", r.patches);
  if (const lw_result result = readTarget(r.context->api, r.host, target, rgba.data())) return result;
  for (size_t i = 0; i < r.patches; ++i)
    for (size_t k = 0; k < 3; ++k) rgb[i * 3 + k] = std::max(rgba[i * 4 + k], 0.0f);
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;

lw_result lw_gl_radiosity_step(lw_gl_radiosity* r, uint32_t sweeps) {
  if (!r) return LW_INVALID_ARGUMENT;
  const gl::StateGuard guard(r->context->api);
  for (uint32_t i = 0; i < sweeps; ++i) gl::sweep(*r, gl::kPlain);
  return LW_OK;
}

/// Chebyshev semi-iteration (Golub, Varga, "Chebyshev Semi-Iterative Methods", 1961): x(k + 1) = x(k − 1) + ω(k + 1) (G x(k) − x(k − 1)), whose error after k sweeps
/// is 1 / T_k(1 / gain) of the first, with nothing to be read back. Products of reflection are symmetric in the measure of area over albedo: their eigenvalues
/// are real.
lw_result lw_gl_radiosity_solve(lw_gl_radiosity* r, double tolerance, uint32_t most_sweeps, uint32_t* sweeps) {
  if (!r) return LW_INVALID_ARGUMENT;
  if (!(tolerance > 0)) return r->host.fail(LW_INVALID_ARGUMENT, "the tolerance is not positive");
  const double gain = double(std::max({r->gain_rgb[0], r->gain_rgb[1], r->gain_rgb[2]}));
  double needed = 1;
  if (gain > 0 && tolerance < 1) needed = std::ceil(std::acosh(1 / tolerance) / std::acosh(1 / gain));
  const uint32_t count = needed < double(most_sweeps) ? uint32_t(needed) : most_sweeps;
  float omega[4] = {1, 1, 1, 1};
  const gl::StateGuard guard(r->context->api);
  for (uint32_t k = 0; k < count; ++k) {
    for (int c = 0; c < 3 && k > 0; ++c) {
      const float square = r->gain_rgb[c] * r->gain_rgb[c];
      omega[c] = 1 / (1 - square * omega[c] / (k == 1 ? 2.0f : 4.0f));
    }
    gl::sweep(*r, omega);
  }
  if (sweeps) *sweeps = count;
  return LW_OK;
}

lw_result lw_gl_radiosity_shade(lw_gl_radiosity* r, const lw_radiosity_shading* given) {
  if (!r) return LW_INVALID_ARGUMENT;
  const lw_radiosity_shading shading = given ? *given : lw_radiosity_shading LW_RADIOSITY_SHADING_INIT;
  if (shading.size < sizeof shading || shading.fill > 1 || shading.light > (LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS | LW_RADIOSITY_LIGHTS))
    return r->host.fail(LW_INVALID_ARGUMENT, "lw_radiosity_shading: a value is out of range");
  const lw_gl& context = *r->context;
  const gl::Api& api = context.api;
  const gl::StateGuard guard(api);
  const bool indirect = shading.light & LW_RADIOSITY_INDIRECT, emitters = shading.light & LW_RADIOSITY_EMITTERS;
  const bool part = r->emits && indirect != emitters;
  if (part && !r->emitters_valid) {
    gl::updateNodes(*r, LW_RADIOSITY_EMITTERS);
    gl::gather(*r, r->irradiance[r->current], gl::kPlain, r->emitters);
    r->emitters_valid = true;
  }
  const float amounts[4] = {indirect ? 1.0f : 0.0f, part ? indirect ? -1.0f : 1.0f : 0.0f, shading.light & LW_RADIOSITY_LIGHTS ? 1.0f : 0.0f, 0};
  const gl::Program& program = context.radiosity_shade;
  api.UseProgram(program.name);
  api.Uniform1i(program.uniform[gl::radiosity_shade_uniform::fill], int32_t(shading.fill));
  api.Uniform4fv(program.uniform[gl::radiosity_shade_uniform::amounts], 1, amounts);
  api.Uniform1f(program.uniform[gl::radiosity_shade_uniform::max], r->max_value);
  gl::bind(api, 0, gl::kTexture2d, r->texel_map);
  gl::bind(api, 1, gl::kTexture2dArray, r->texel_patch);
  gl::bind(api, 2, gl::kTexture2dArray, r->texel_weight);
  gl::bind(api, 3, gl::kTexture2d, r->irradiance[r->current].texture);
  gl::bind(api, 4, gl::kTexture2d, r->emitters.texture);
  gl::bind(api, 5, gl::kTexture2d, r->direct.texture);
  api.BindFramebuffer(gl::kDrawFramebuffer, r->atlas.framebuffer);
  api.Viewport(0, 0, r->atlas.width, r->atlas.height);
  api.BindVertexArray(context.vertex_array);
  api.DrawArrays(gl::kTriangles, 0, 3);
  return LW_OK;
}

lw_result lw_gl_radiosity_read_irradiance(lw_gl_radiosity* r, float* rgb) { return r && rgb ? gl::readPatches(*r, r->irradiance[r->current], rgb) : LW_INVALID_ARGUMENT; }
lw_result lw_gl_radiosity_read_direct(lw_gl_radiosity* r, float* rgb) { return r && rgb ? gl::readPatches(*r, r->direct, rgb) : LW_INVALID_ARGUMENT; }
lw_result lw_gl_radiosity_read_atlas(lw_gl_radiosity* r, float* rgba) { return r && rgba ? gl::readTarget(r->context->api, r->host, r->atlas, rgba) : LW_INVALID_ARGUMENT; }
