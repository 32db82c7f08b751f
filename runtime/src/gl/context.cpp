#include "runtime/src/gl/context.h"

#include "runtime/src/gl/shaders.h"
#include "runtime/src/light.h"

#include <cstring>
#include <initializer_list>

namespace gl = lightwell::runtime::gl;
using gl::Name;

namespace {

Name compileShader(const lw_gl& context, gl::Enum type, std::initializer_list<const char*> parts, const char* what, lw_result& result) {
  const gl::Api& api = context.api;
  const char* sources[8] = {api.embedded ? gl::glsl::kVersionEmbedded : gl::glsl::kVersionDesktop};
  int32_t count = 1;
  for (const char* part : parts) sources[count++] = part;
  const Name shader = api.CreateShader(type);
  api.ShaderSource(shader, count, sources, nullptr);
  api.CompileShader(shader);
  int32_t compiled = 0;
  api.GetShaderiv(shader, gl::kCompileStatus, &compiled);
  if (!compiled && !result) {
    char log[800] = {};
    api.GetShaderInfoLog(shader, sizeof log, nullptr, log);
    result = context.host.fail(LW_GL_FAILED, "the %s shader does not compile: %s", what, log);
  }
  return shader;
}

Name createShadowSampler(const gl::Api& api, gl::Enum compare) {
  Name sampler = 0;
  api.GenSamplers(1, &sampler);
  const struct {
    gl::Enum name, value;
  } parameters[] = {{gl::kTextureMinFilter, gl::kLinear}, {gl::kTextureMagFilter, gl::kLinear}, {gl::kTextureWrapS, gl::kClampToEdge},
                    {gl::kTextureWrapT, gl::kClampToEdge}, {gl::kTextureWrapR, gl::kClampToEdge},
                    {gl::kTextureCompareMode, gl::kCompareRefToTexture}, {gl::kTextureCompareFunc, compare}};
  for (const auto& p : parameters) api.SamplerParameteri(sampler, p.name, int32_t(p.value));
  return sampler;
}

}  // namespace

lw_result gl::compileProgram(const lw_gl& context, const char* what, std::initializer_list<const char*> fragment,
                             std::initializer_list<const char*> samplers, std::initializer_list<const char*> uniforms, Program& program,
                             std::initializer_list<const char*> vertex) {
  const Api& api = context.api;
  lw_result result = LW_OK;
  const Name vertex_shader = compileShader(context, gl::kVertexShader, vertex, "vertex", result);
  const Name fragment_shader = compileShader(context, gl::kFragmentShader, fragment, what, result);
  program.name = api.CreateProgram();
  api.AttachShader(program.name, vertex_shader);
  api.AttachShader(program.name, fragment_shader);
  api.LinkProgram(program.name);
  api.DeleteShader(vertex_shader);
  api.DeleteShader(fragment_shader);
  int32_t linked = 0;
  api.GetProgramiv(program.name, gl::kLinkStatus, &linked);
  if (!linked && !result) {
    char log[800] = {};
    api.GetProgramInfoLog(program.name, sizeof log, nullptr, log);
    result = context.host.fail(LW_GL_FAILED, "the %s program does not link: %s", what, log);
  }
  if (result) return result;
  api.UseProgram(program.name);
  int32_t unit = 0, index = 0;
  for (const char* name : samplers) api.Uniform1i(api.GetUniformLocation(program.name, name), unit++);
  for (const char* name : uniforms) program.uniform[index++] = api.GetUniformLocation(program.name, name);
  return LW_OK;
}

lw_result lw_gl::compilePrograms() {
  using namespace gl::glsl;
  using gl::compileProgram;
  lw_result result = compileProgram(
      *this, "entry", {kAddress, kLight, kEntries},
      {"u_position", "u_normal", "u_previous", "u_shadow_2d", "u_shadow_cube", "u_visibility", "u_rectangle"},
      {"u_entries", "u_light_count", "u_accumulate", "u_shadow", "u_reversed", "u_light", "u_shadow_numbers", "u_shadow_matrix"}, entries);
  if (!result)
    result = compileProgram(*this, "cluster", {kAddress, kClusters}, {"u_range", "u_position", "u_entry", "u_pane_sum"}, {"u_clusters"}, clusters);
  if (!result) result = compileProgram(*this, "rank", {kAddress, kRank}, {"u_cluster"}, {"u_clusters"}, rank);
  if (!result)
    result = compileProgram(*this, "selection", {kAddress, kSelect}, {"u_cluster", "u_rank", "u_pane_sum"},
                     {"u_clusters", "u_brightest", "u_keep_energy"}, select);
  if (!result)
    result = compileProgram(*this, "pane", {kAddress, kOwnValue, kPanes},
                     {"u_texel_map", "u_weight", "u_pane", "u_constant", "u_buried"},
                     {"u_weights", "u_selected", "u_texels", "u_emitters", "u_constants", "u_sky", "u_max", "u_fill", "u_buried_count"}, panes);
  if (!result)
    result = compileProgram(*this, "reconstruction", {kAddress, kLocalBases, kOwnValue, kReconstruct},
                     {"lw_texel_map", "lw_basis", "lw_amount", "u_constant", "u_buried"},
                     {"lw_quads", "u_emitters", "u_constants", "u_sky", "u_max", "u_fill", "u_buried_count", "u_keep"}, reconstruct);
  if (!result)
    result = compileProgram(*this, "patch radiosity", {kAddress, kRadiosityPatches}, {"u_albedo", "u_emitted", "u_direct", "u_irradiance", "u_kept"},
                     {"u_patches", "u_light"}, radiosity_patches);
  if (!result)
    result = compileProgram(*this, "node radiosity", {kAddress, kRadiosityNodes}, {"u_node", "u_share"}, {"u_begin", "u_end", "u_child_begin"}, radiosity_nodes);
  if (!result)
    result = compileProgram(*this, "radiosity gathering", {kAddress, kRadiosityGather}, {"u_link", "u_row", "u_run", "u_gate", "u_node", "u_previous"},
                     {"u_patches", "u_omega"}, radiosity_gather);
  if (!result)
    result = compileProgram(*this, "radiosity", {kAddress, kRadiosityShade},
                     {"u_texel_map", "u_texel_patch", "u_texel_weight", "u_irradiance", "u_emitters", "u_direct"}, {"u_fill", "u_amounts", "u_max"},
                     radiosity_shade);
  if (!result)
    result = compileProgram(*this, "view of a light", {kAddress, kAlphaTest, kInjectSee},
                     {"u_corner", "u_triangle", "u_texel_patches", "u_patch", "u_alpha_material", "u_alpha", "u_leaf"},
                     {"u_eye", "u_right", "u_up", "u_forward", "u_range"}, inject_see, {kAddress, kLampViewVertex});
  if (!result)
    result = compileProgram(*this, "light injection", {kInjectAdd}, {"u_seen", "u_patch"}, {"u_side", "u_light", "u_cone", "u_spot"}, inject_add,
                     {kAddress, kInjectAddVertex});
  if (!result)
    result = compileProgram(*this, "probe", {kAddress, kProbes}, {"u_link", "u_probe", "u_run", "u_gate", "u_node"}, {"u_probes", "u_groups"}, probes);
  return result;
}

lw_result lw_gl_create(const lw_gl_config* config, lw_gl** out) {
  if (!config || config->size < sizeof(lw_gl_config) || !config->loader || !config->allocate != !config->release || !out)
    return LW_INVALID_ARGUMENT;
  const lightwell::runtime::Host host({config->allocate, config->release, config->allocator_user}, config->message, config->message_user);
  lw_gl* context = lightwell::runtime::createHandle<lw_gl>(host);
  if (!context) return host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the GL evaluator");
  lw_result result = context->api.load(*config, host);
  if (result) {
    lightwell::runtime::destroyHandle(context);
    return result;
  }
  {
    const gl::StateGuard guard(context->api);
    context->api.GenVertexArrays(1, &context->vertex_array);
    context->shadow_sampler[0] = createShadowSampler(context->api, gl::kLequal);
    context->shadow_sampler[1] = createShadowSampler(context->api, gl::kGequal);
    result = context->compilePrograms();
    context->api.clearErrors();
  }
  if (result) {
    lw_gl_destroy(context);
    return result;
  }
  *out = context;
  return LW_OK;
}

void lw_gl_destroy(lw_gl* context) {
  if (!context) return;
  const gl::Api& api = context->api;
  api.DeleteVertexArrays(1, &context->vertex_array);
  api.DeleteSamplers(2, context->shadow_sampler);
  for (const gl::Program* program : {&context->entries, &context->clusters, &context->rank, &context->select, &context->panes,
                                     &context->reconstruct, &context->radiosity_patches, &context->radiosity_nodes,
                                     &context->radiosity_gather, &context->radiosity_shade, &context->inject_see, &context->inject_add, &context->probes})
    if (program->name) api.DeleteProgram(program->name);
  lightwell::runtime::destroyHandle(context);
}

const char* lw_glsl_source(lw_glsl snippet) {
  switch (snippet) {
    case LW_GLSL_ATLAS: return gl::glsl::kAtlas;
    case LW_GLSL_LIGHT: return gl::glsl::kLight;
    case LW_GLSL_LOCAL_BASES: return gl::glsl::kLocalBases;
    case LW_GLSL_ENVIRONMENT: return gl::glsl::kEnvironment;
    case LW_GLSL_PROBES: return gl::glsl::kProbeLight;
    case LW_GLSL_BLOCKERS: return gl::glsl::kBlockers;
    case LW_GLSL_LIGHTMAP: return gl::glsl::kLightmap;
  }
  return nullptr;
}

lw_result lw_gl_pack_light(const lw_light* light, float packed[16]) {
  lightwell::runtime::PackedLight values;
  if (!light || !packed || lightwell::runtime::packLight(*light, values)) return LW_INVALID_ARGUMENT;
  std::memcpy(packed, &values, sizeof values);
  return LW_OK;
}
