// What is shared by everything of one GL context: functions, programs, samplers.
#pragma once
#include <initializer_list>

#include "runtime/src/gl/api.h"
#include "runtime/src/gl/shaders.h"
#include "runtime/src/gl/state.h"

namespace lightwell::runtime::gl {

/// A program and its uniforms, in the order of the names given to compile().
struct Program {
  static constexpr int kMaxUniforms = 10;
  Name name = 0;
  int32_t uniform[kMaxUniforms] = {};
};

}  // namespace lightwell::runtime::gl

struct lw_gl {
  using Program = lightwell::runtime::gl::Program;
  lightwell::runtime::Host host;
  lightwell::runtime::gl::Api api;
  uint32_t vertex_array = 0;           // empty: vertices come from gl_VertexID
  uint32_t shadow_sampler[2] = {};     // plain, reversed depth
  // Programs, made when something of the context needs them first; see programs.h.
  Program entries[4];                  // by the lights' kind of shadow
  Program clusters, rank, select, panes, reconstruct;
  Program radiosity_patches, radiosity_nodes, radiosity_gather, radiosity_shade, inject_see, inject_add, probes;
};

namespace lightwell::runtime::gl {

/// Compiles and links; the program is in use afterwards. Samplers are given in the order of the units that they read from, uniforms in that of Program::uniform;
/// at most seven parts of source each. LW_GL_FAILED, with the compiler's log and `what` in the message.
lw_result compileProgram(const lw_gl& context, const char* what, std::initializer_list<const char*> fragment,
                         std::initializer_list<const char*> samplers, std::initializer_list<const char*> uniforms, Program& program,
                         std::initializer_list<const char*> vertex = {glsl::kVertex});

}  // namespace lightwell::runtime::gl
