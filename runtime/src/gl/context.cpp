#include "runtime/src/gl/context.h"

#include "runtime/src/gl/programs.h"
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
  if (result) {
    api.DeleteProgram(program.name);
    program.name = 0;
    return result;
  }
  api.UseProgram(program.name);
  int32_t unit = 0, index = 0;
  for (const char* name : samplers) api.Uniform1i(api.GetUniformLocation(program.name, name), unit++);
  for (const char* name : uniforms) program.uniform[index++] = api.GetUniformLocation(program.name, name);
  return LW_OK;
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
  gl::deletePrograms(*context);
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
