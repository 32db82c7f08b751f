// The weighted sum of panes, or of local bases, into the atlas texture; and reading results back for tools.
#include <cstring>

#include "runtime/src/gl/prm_gl.h"
#include "runtime/src/prm.h"

namespace lightwell::runtime::gl {
namespace {

/// Ranks the clusters and gathers the first K; see kSelect.
void selectBrightest(const lw_gl_prm& prm, uint32_t brightest, bool keep_energy) {
  const lw_gl& context = *prm.context;
  const Api& api = context.api;
  api.UseProgram(context.rank.name);
  api.Uniform1i(context.rank.uniform[rank_uniform::clusters], int32_t(prm.clusters));
  bindUnit(api, 0, kTexture2d, prm.cluster.texture);
  drawInto(prm, prm.rank);
  api.UseProgram(context.select.name);
  api.Uniform1i(context.select.uniform[select_uniform::clusters], int32_t(prm.clusters));
  api.Uniform1i(context.select.uniform[select_uniform::brightest], int32_t(brightest));
  api.Uniform1i(context.select.uniform[select_uniform::keep_energy], keep_energy);
  bindUnit(api, 1, kTexture2d, prm.rank.texture);
  bindUnit(api, 2, kTexture2dArray, prm.pane_sum);
  drawInto(prm, prm.selected);
}

/// What kOwnValue adds to the texels, and how much of it.
struct Constants {
  uint32_t bits;  // LW_EMITTERS_…, LW_SKY_…: those that there are
  float sky_rgb[4];
};
Constants constantsOf(const lw_gl_prm& prm, const lw_prm_options& options) {
  uint32_t there = 0;
  if (prm.has_emitter) there |= LW_EMITTERS_DIRECT | LW_EMITTERS_INDIRECT;
  if (prm.has_sky) there |= LW_SKY_DIRECT | LW_SKY_INDIRECT;
  const float* sky = options.sky_rgb;
  return {options.emitters & there, {sky[0] * prm.sky_scale, sky[1] * prm.sky_scale, sky[2] * prm.sky_scale, 0}};
}

/// The inputs of kOwnValue, except for u_fill and u_buried_count. `first`: the place of u_emitters among the program's uniforms.
void setConstants(const lw_gl_prm& prm, const Program& program, int first, const Constants& constants) {
  const Api& api = prm.context->api;
  api.Uniform1i(program.uniform[first], int32_t(constants.bits));
  api.Uniform1i(program.uniform[first + 1], int32_t(prm.constants));
  api.Uniform4fv(program.uniform[first + 2], 1, constants.sky_rgb);
  bindUnit(api, 3, kTexture2dArray, prm.constant);
  bindUnit(api, 4, kTexture2dArray, prm.buried);
}

void evaluatePanes(const lw_gl_prm& prm, const lw_prm_options& options) {
  const lw_gl& context = *prm.context;
  const Api& api = context.api;
  const bool selected = options.brightest && options.brightest < prm.clusters;
  if (selected) selectBrightest(prm, options.brightest, options.keep_energy != 0);
  const Program& program = context.panes;
  api.UseProgram(program.name);
  api.Uniform1i(program.uniform[panes_uniform::weights], int32_t(selected ? options.brightest : prm.clusters));
  api.Uniform1i(program.uniform[panes_uniform::selected], selected);
  api.Uniform1i(program.uniform[panes_uniform::texels], int32_t(prm.texels));
  setConstants(prm, program, panes_uniform::emitters, constantsOf(prm, options));
  api.Uniform1f(program.uniform[panes_uniform::max], prm.max_value);
  api.Uniform1i(program.uniform[panes_uniform::fill], int32_t(options.fill));
  api.Uniform1i(program.uniform[panes_uniform::buried_count], int32_t(prm.buried_count));
  bindUnit(api, 0, kTexture2d, prm.texel_map);
  bindUnit(api, 1, kTexture2d, selected ? prm.selected.texture : prm.cluster.texture);
  bindUnit(api, 2, kTexture2dArray, prm.pane);
  drawInto(prm, prm.atlas);
}

/// Brings the clusters' light to cluster_rgb, if it is not there.
lw_result readClusters(lw_gl_prm& prm) {
  if (prm.clusters_on_cpu) return LW_OK;
  if (const lw_result result = readTarget(prm.context->api, prm.host, clusterLight(prm), prm.cluster_rgba.data())) return result;
  for (size_t c = 0; c < prm.clusters; ++c) std::memcpy(&prm.cluster_rgb[c * 3], &prm.cluster_rgba[c * 4], 3 * sizeof(float));
  prm.clusters_on_cpu = true;
  return LW_OK;
}

/// Sums the blocks' amounts on the CPU, from the clusters' light as it was given or is read back, and uploads them.
lw_result updateCoefficients(lw_gl_prm& prm, float tolerance) {
  const Api& api = prm.context->api;
  if (const lw_result result = readClusters(prm)) return result;
  const lw_prm& transport = *prm.transport;
  prm.sums.update(transport, prm.cluster_rgb.data(), tolerance);
  const size_t layer = size_t(prm.amount_width) * size_t(prm.amount_height) * 4;
  for (size_t block = 0; block < prm.blocks; ++block) {
    float* first = &prm.amount_rgba[block * prm.quads * 4];
    const bool touched = prm.sums.touched(transport, block);
    first[layer * 3] = touched ? 0.0f : 1.0f;
    if (!touched) continue;
    const float *sum = prm.sums.sums(transport, block), *scale = transport.links.scale(block);
    for (size_t k = 0; k < transport.block_rank[block]; ++k)
      for (size_t c = 0; c < 3; ++c) first[c * layer + k] = sum[k * 3 + c] * scale[k * 3 + c];
  }
  bindUnit(api, 0, kTexture2dArray, prm.amount);
  api.TexSubImage3D(kTexture2dArray, 0, 0, 0, 0, prm.amount_width, prm.amount_height, 4, kTexelRgba32f.format, kTexelRgba32f.type, prm.amount_rgba.data());
  return LW_OK;
}

/// Whether the atlas still shows what these options ask for wherever sums have not changed.
bool keepsUntouched(const lw_gl_prm& prm, const lw_prm_options& options) {
  return prm.owns_atlas && prm.drawn && showTheSame(prm.drawn_options, options);
}

void reconstruct(lw_gl_prm& prm, const lw_prm_options& options) {
  const lw_gl& context = *prm.context;
  const Api& api = context.api;
  const Program& program = context.reconstruct;
  api.UseProgram(program.name);
  api.Uniform1i(program.uniform[reconstruct_uniform::quads], int32_t(prm.quads));
  setConstants(prm, program, reconstruct_uniform::emitters, constantsOf(prm, options));
  api.Uniform1f(program.uniform[reconstruct_uniform::max], prm.max_value);
  api.Uniform1i(program.uniform[reconstruct_uniform::fill], int32_t(options.fill));
  api.Uniform1i(program.uniform[reconstruct_uniform::buried_count], int32_t(prm.buried_count));
  api.Uniform1i(program.uniform[reconstruct_uniform::keep], keepsUntouched(prm, options));
  bindUnit(api, 0, kTexture2d, prm.texel_map);
  bindUnit(api, 1, kTexture2dArray, prm.basis);
  bindUnit(api, 2, kTexture2dArray, prm.amount);
  drawInto(prm, prm.atlas);
  prm.drawn = true;
  prm.drawn_options = options;
  prm.sums.forget(*prm.transport);
}

lw_result readRgb(const lw_gl_prm& prm, const Target& target, uint32_t count, float* rgb) {
  Array<float> rgba;
  if (!rgba.allocate(prm.host, size_t(target.width) * size_t(target.height) * 4))
    return prm.host.fail(LW_OUT_OF_MEMORY, "no memory to read back %u values", count);
  if (const lw_result result = readTarget(prm.context->api, prm.host, target, rgba.data())) return result;
  for (size_t i = 0; i < count; ++i) std::memcpy(rgb + i * 3, &rgba[i * 4], 3 * sizeof(float));
  return LW_OK;
}

}  // namespace
}  // namespace lightwell::runtime::gl

using namespace lightwell::runtime;
using namespace lightwell::runtime::gl;

lw_result lw_gl_evaluate(lw_gl_prm* prm, const lw_prm_options* given) {
  if (!prm) return LW_INVALID_ARGUMENT;
  lw_prm_options options;
  if (!resolveOptions(given, options)) return prm->host.fail(LW_INVALID_ARGUMENT, "lw_prm_options: a value is out of range");
  const StateGuard guard(prm->context->api);
  if (prm->panes) {
    evaluatePanes(*prm, options);
  } else if (prm->state) {
    if (const lw_result result = readClusters(*prm)) return result;
    return evaluateOnCpu(*prm, options);
  } else {
    if (const lw_result result = updateCoefficients(*prm, options.tolerance)) return result;
    reconstruct(*prm, options);
  }
  return LW_OK;
}

lw_result lw_gl_update_coefficients(lw_gl_prm* prm) {
  if (!prm) return LW_INVALID_ARGUMENT;
  if (prm->panes) return prm->host.fail(LW_INVALID_ARGUMENT, "panes have no coefficients");
  const StateGuard guard(prm->context->api);
  constexpr lw_prm_options kDefault = LW_PRM_OPTIONS_INIT;
  return updateCoefficients(*prm, kDefault.tolerance);
}

lw_result lw_gl_bind_local_bases(lw_gl_prm* prm, uint32_t program, uint32_t first_unit) {
  if (!prm || !program) return LW_INVALID_ARGUMENT;
  if (prm->panes) return prm->host.fail(LW_INVALID_ARGUMENT, "panes have no local bases");
  const Api& api = prm->context->api;
  const int32_t location = api.GetUniformLocation(program, "lw_quads");
  if (location < 0) return prm->host.fail(LW_NOT_FOUND, "the program does not use lwLocalBasesIrradiance");
  int32_t previous_program = 0, active_texture = 0;
  api.GetIntegerv(kCurrentProgram, &previous_program);
  api.GetIntegerv(kActiveTexture, &active_texture);
  api.UseProgram(program);
  api.Uniform1i(location, int32_t(prm->quads));
  const struct {
    const char* sampler;
    Enum target;
    Name texture;
  } textures[] = {{"lw_texel_map", kTexture2d, prm->texel_map},
                  {"lw_basis", kTexture2dArray, prm->basis},
                  {"lw_amount", kTexture2dArray, prm->amount}};
  uint32_t unit = first_unit;
  for (const auto& t : textures) {
    api.Uniform1i(api.GetUniformLocation(program, t.sampler), int32_t(unit));
    bindUnit(api, unit, t.target, t.texture);
    api.BindSampler(unit++, 0);
  }
  api.UseProgram(Name(previous_program));
  api.ActiveTexture(Enum(active_texture));
  return LW_OK;
}

lw_result lw_gl_read_entries(lw_gl_prm* prm, float* rgb) {
  return prm && rgb ? readRgb(*prm, prm->entry[prm->current_entry], prm->entries, rgb) : LW_INVALID_ARGUMENT;
}

lw_result lw_gl_read_clusters(lw_gl_prm* prm, float* rgb) {
  return prm && rgb ? readRgb(*prm, clusterLight(*prm), prm->clusters, rgb) : LW_INVALID_ARGUMENT;
}

lw_result lw_gl_read_atlas(lw_gl_prm* prm, float* rgba) {
  return prm && rgba ? readTarget(prm->context->api, prm->host, prm->atlas, rgba) : LW_INVALID_ARGUMENT;
}
