// Light at the entry points, light after light, and its averages over the clusters.
#include <cmath>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/gl/prm_gl.h"
#include "runtime/src/light.h"
#include "runtime/src/prm.h"

namespace lightwell::runtime::gl {

void bindUnit(const Api& api, uint32_t unit, Enum target, Name texture) {
  api.ActiveTexture(kTexture0 + unit);
  api.BindTexture(target, texture);
}

void drawInto(const lw_gl_prm& prm, const Target& target) {
  const Api& api = prm.context->api;
  api.BindFramebuffer(kDrawFramebuffer, target.framebuffer);
  api.Viewport(0, 0, target.width, target.height);
  api.BindVertexArray(prm.context->vertex_array);
  api.DrawArrays(kTriangles, 0, 3);
}

namespace {

constexpr uint32_t kBatch = 16;  // lights without shadow in one draw; the size of u_light

const char* checkLight(const lw_gl_light& light) {
  PackedLight packed;
  if (const char* reason = packLight(light.light, packed)) return reason;
  if (light.shadow > LW_GL_SHADOW_VISIBILITY) return "its kind of shadow is unknown";
  if (light.shadow != LW_GL_SHADOW_NONE && !light.shadow_texture) return "its shadow texture is missing";
  if (light.reversed_depth > 1 || !std::isfinite(light.depth_bias) || !std::isfinite(light.normal_offset_m))
    return "its bias, offset or depth order is out of range";
  if (light.shadow == LW_GL_SHADOW_2D && !allFinite(light.shadow_matrix, 16)) return "its shadow matrix is not finite";
  if (light.shadow == LW_GL_SHADOW_CUBE) {
    if (light.light.type == LW_LIGHT_DIRECTIONAL) return "a directional light has no cube map";
    if (!(light.near_m > 0 && light.near_m < light.far_m && std::isfinite(light.far_m))) return "its planes are not 0 < near < far";
  }
  return nullptr;
}

/// Adds the first `count` lights, which share one kind of shadow, to what the last draw left.
void drawLights(lw_gl_prm& prm, const lw_gl_light* lights, uint32_t count, bool accumulate) {
  namespace u = entries_uniform;
  const Api& api = prm.context->api;
  const lw_gl_light* shadowed = count && lights[0].shadow != LW_GL_SHADOW_NONE ? lights : nullptr;
  const Program& program = prm.context->entries[shadowed ? shadowed->shadow : uint32_t(LW_GL_SHADOW_NONE)];
  api.UseProgram(program.name);
  api.Uniform1i(program.uniform[u::entries], int32_t(prm.entries));
  PackedLight packed[kBatch];
  for (uint32_t l = 0; l < count; ++l) packLight(lights[l].light, packed[l]);
  api.Uniform1i(program.uniform[u::light_count], int32_t(count));
  api.Uniform1i(program.uniform[u::accumulate], accumulate);
  if (count) api.Uniform4fv(program.uniform[u::light], int32_t(count * 4), packed[0].position_m);
  constexpr float kNoNumbers[4] = {};
  api.Uniform4fv(program.uniform[u::shadow_numbers], 1, kNoNumbers);
  if (shadowed) {
    const float numbers[4] = {shadowed->near_m, shadowed->far_m, shadowed->depth_bias, shadowed->normal_offset_m};
    api.Uniform4fv(program.uniform[u::shadow_numbers], 1, numbers);
    api.Uniform1i(program.uniform[u::reversed], int32_t(shadowed->reversed_depth));
    api.UniformMatrix4fv(program.uniform[u::shadow_matrix], 1, 0, shadowed->shadow_matrix);
    constexpr Enum kTargets[] = {0, kTexture2d, kTextureCubeMap, kTexture2dArray};
    const uint32_t unit = 2 + shadowed->shadow;  // u_shadow_2d, u_shadow_cube, u_visibility
    bindUnit(api, unit, kTargets[shadowed->shadow], shadowed->shadow_texture);
    if (shadowed->shadow != LW_GL_SHADOW_VISIBILITY) api.BindSampler(unit, prm.context->shadow_sampler[shadowed->reversed_depth]);
  }
  bindUnit(api, 2, kTexture2d, prm.entry[prm.current_entry].texture);
  prm.current_entry ^= 1;
  drawInto(prm, prm.entry[prm.current_entry]);
  if (shadowed) api.BindSampler(2 + shadowed->shadow, 0);
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;
using namespace lightwell::runtime::gl;

lw_result lw_gl_update_entries(lw_gl_prm* prm, const lw_gl_light* lights, uint32_t count) {
  if (!prm || (count && !lights)) return LW_INVALID_ARGUMENT;
  for (uint32_t l = 0; l < count; ++l)
    if (const char* reason = checkLight(lights[l])) return prm->host.fail(LW_INVALID_ARGUMENT, "light %u: %s", l, reason);
  lw_gl& context = *prm->context;
  const Api& api = context.api;
  const StateGuard guard(api);
  if (count == 0)
    if (const lw_result result = prepareEntries(context, LW_GL_SHADOW_NONE)) return result;
  for (uint32_t l = 0; l < count; ++l)
    if (const lw_result result = prepareEntries(context, lights[l].shadow)) return result;
  bindUnit(api, 0, kTexture2dArray, prm->entry_position);
  bindUnit(api, 1, kTexture2dArray, prm->entry_normal);
  bindUnit(api, 6, kTexture2dArray, prm->entry_rectangle);
  prm->clusters_on_cpu = false;
  uint32_t done = 0;
  do {
    uint32_t batch = count ? 1 : 0;
    if (count && lights[done].shadow == LW_GL_SHADOW_NONE)
      while (batch < kBatch && done + batch < count && lights[done + batch].shadow == LW_GL_SHADOW_NONE) ++batch;
    drawLights(*prm, lights + done, batch, done > 0);
    done += batch;
  } while (done < count);
  prm->clusters_in_entries = prm->entries_are_clusters;
  if (prm->clusters_in_entries) return LW_OK;

  api.UseProgram(context.clusters.name);
  api.Uniform1i(context.clusters.uniform[clusters_uniform::clusters], int32_t(prm->clusters));
  bindUnit(api, 0, kTexture2dArray, prm->cluster_range);
  bindUnit(api, 1, kTexture2dArray, prm->entry_position);
  bindUnit(api, 2, kTexture2d, prm->entry[prm->current_entry].texture);
  bindUnit(api, 3, kTexture2dArray, prm->pane_sum);
  drawInto(*prm, prm->cluster);
  return LW_OK;
}

lw_result lw_gl_prepare_shadow(lw_gl* context, uint32_t shadow) {
  if (!context) return LW_INVALID_ARGUMENT;
  if (shadow > LW_GL_SHADOW_VISIBILITY) return context->host.fail(LW_INVALID_ARGUMENT, "%u is no kind of shadow", shadow);
  const StateGuard guard(context->api);
  return prepareEntries(*context, shadow);
}

lw_result lw_gl_create_visibility(lw_gl_prm* prm, uint32_t* texture) {
  if (!prm || !texture) return LW_INVALID_ARGUMENT;
  Array<float> ones;
  if (!ones.allocate(prm->host, prm->entries)) return prm->host.fail(LW_OUT_OF_MEMORY, "no memory for %u visibilities", prm->entries);
  for (float& v : ones) v = 1.0f;
  const StateGuard guard(prm->context->api);
  uint64_t bytes = 0;
  prm->context->api.clearErrors();
  const Name name = createList(prm->context->api, kTexelR32f, prm->entries, ones.data(), bytes);
  if (prm->context->api.GetError() != kNoError) {
    prm->context->api.DeleteTextures(1, &name);
    return prm->host.fail(LW_OUT_OF_MEMORY, "no texture memory for %u visibilities", prm->entries);
  }
  *texture = name;
  return LW_OK;
}

void lw_gl_destroy_visibility(lw_gl_prm* prm, uint32_t texture) {
  if (prm && texture) prm->context->api.DeleteTextures(1, &texture);
}

lw_result lw_gl_upload_visibility(lw_gl_prm* prm, uint32_t texture, const float* visibility) {
  if (!prm || !texture || !visibility) return LW_INVALID_ARGUMENT;
  if (!isIrradiance(visibility, prm->entries)) return prm->host.fail(LW_INVALID_ARGUMENT, "a visibility is negative or not finite");
  const StateGuard guard(prm->context->api);
  uploadList(prm->context->api, texture, kTexelR32f, prm->entries, visibility);
  return LW_OK;
}

lw_result lw_gl_upload_cluster_irradiance(lw_gl_prm* prm, const float* irradiance_rgb) {
  if (!prm || !irradiance_rgb) return LW_INVALID_ARGUMENT;
  if (!isIrradiance(irradiance_rgb, size_t(prm->clusters) * 3))
    return prm->host.fail(LW_INVALID_ARGUMENT, "an irradiance is negative or not finite");
  Array<float> rgba;
  const size_t padded = size_t(prm->cluster.width) * size_t(prm->cluster.height);
  if (!rgba.allocate(prm->host, padded * 4)) return prm->host.fail(LW_OUT_OF_MEMORY, "no memory for %u clusters", prm->clusters);
  std::memset(rgba.data(), 0, rgba.bytes());
  for (size_t c = 0; c < prm->clusters; ++c) {
    std::memcpy(&rgba[c * 4], &irradiance_rgb[c * 3], 3 * sizeof(float));
    rgba[c * 4 + 3] = contribution(&irradiance_rgb[c * 3], prm->pane_sum_rgb.empty() ? nullptr : &prm->pane_sum_rgb[c * 3]);
  }
  if (!prm->panes) {
    std::memcpy(prm->cluster_rgb.data(), irradiance_rgb, prm->cluster_rgb.bytes());
    prm->clusters_on_cpu = true;
  }
  const Api& api = prm->context->api;
  const StateGuard guard(api);
  prm->clusters_in_entries = false;
  bindUnit(api, 0, kTexture2d, prm->cluster.texture);
  api.TexSubImage2D(kTexture2d, 0, 0, 0, prm->cluster.width, prm->cluster.height, kTexelRgba32f.format, kTexelRgba32f.type, rgba.data());
  return LW_OK;
}
