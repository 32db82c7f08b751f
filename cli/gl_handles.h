// The OpenGL runtime's handles with owners. They end in the context that they were made in.
#pragma once
#include <memory>

#include "lightwell/lightwell_gl.h"

namespace lightwell::cli {

struct DestroyGl {
  void operator()(lw_gl* gl) const { lw_gl_destroy(gl); }
};
struct DestroyGlPrm {
  void operator()(lw_gl_prm* prm) const { lw_gl_prm_destroy(prm); }
};
struct DestroyGlRadiosity {
  void operator()(lw_gl_radiosity* gl_radiosity) const { lw_gl_radiosity_destroy(gl_radiosity); }
};
struct DestroyGlRadiosityInjector {
  void operator()(lw_gl_radiosity_injector* injector) const { lw_gl_radiosity_injector_destroy(injector); }
};
struct DestroyGlProbes {
  void operator()(lw_gl_probes* gl_probes) const { lw_gl_probes_destroy(gl_probes); }
};
using GlProbesHandle = std::unique_ptr<lw_gl_probes, DestroyGlProbes>;
using GlRadiosityInjectorHandle = std::unique_ptr<lw_gl_radiosity_injector, DestroyGlRadiosityInjector>;
using GlRadiosityHandle = std::unique_ptr<lw_gl_radiosity, DestroyGlRadiosity>;
using GlHandle = std::unique_ptr<lw_gl, DestroyGl>;
using GlPrmHandle = std::unique_ptr<lw_gl_prm, DestroyGlPrm>;

}  // namespace lightwell::cli
