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
  Program entries, clusters, rank, select, panes, reconstruct;
  Program radiosity_patches, radiosity_nodes, radiosity_gather, radiosity_shade, inject_see, inject_add, probes;

  lw_result compilePrograms();
};

namespace lightwell::runtime::gl {

/// Compiles and links; the program is in use afterwards. Samplers are given in the order of the units that they read from, uniforms in that of Program::uniform;
/// at most seven parts of source each. LW_GL_FAILED, with the compiler's log and `what` in the message.
lw_result compileProgram(const lw_gl& context, const char* what, std::initializer_list<const char*> fragment,
                         std::initializer_list<const char*> samplers, std::initializer_list<const char*> uniforms, Program& program,
                         std::initializer_list<const char*> vertex = {glsl::kVertex});

// The uniforms of each program: indices into Program::uniform.
namespace entries_uniform {
enum { entries, light_count, accumulate, shadow, reversed, light, shadow_numbers, shadow_matrix };
}
namespace clusters_uniform {
enum { clusters };
}
namespace rank_uniform {
enum { clusters };
}
namespace select_uniform {
enum { clusters, brightest, keep_energy };
}
namespace panes_uniform {
enum { weights, selected, texels, emitters, constants, sky, max, fill, buried_count };
}
namespace reconstruct_uniform {
enum { quads, emitters, constants, sky, max, fill, buried_count, keep };
}
namespace radiosity_patches_uniform {
enum { patches, light };
}
namespace radiosity_nodes_uniform {
enum { begin, end, child_begin };
}
namespace radiosity_gather_uniform {
enum { patches, omega };
}
namespace radiosity_shade_uniform {
enum { fill, amounts, max };
}
namespace probes_uniform {
enum { probes, groups };
}
namespace inject_see_uniform {
enum { eye, right, up, forward, range };  // the first four as setView has them
}
namespace inject_add_uniform {
enum { side, light, cone, spot };
}

}  // namespace lightwell::runtime::gl
