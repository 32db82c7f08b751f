// The programs of a context, compiled for what it meets: the techniques of its handles, the kinds of shadow of its lights.
#pragma once
#include "runtime/src/gl/context.h"

namespace lightwell::runtime::gl {

/// Each compiles those of its programs that are not there yet, and fails as compileProgram does. Inside a StateGuard.
lw_result prepareEntries(lw_gl& context, uint32_t shadow);  // of lights with this LW_GL_SHADOW_…
lw_result prepareClusters(lw_gl& context);                  // averages of several entries
lw_result preparePanes(lw_gl& context);
lw_result prepareLocalBases(lw_gl& context);
lw_result prepareRadiosity(lw_gl& context);
lw_result prepareInjection(lw_gl& context);
lw_result prepareProbes(lw_gl& context);

void deletePrograms(lw_gl& context);

// The uniforms of each program: indices into Program::uniform.
namespace entries_uniform {
enum { entries, light_count, accumulate, reversed, light, shadow_numbers, shadow_matrix };
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
