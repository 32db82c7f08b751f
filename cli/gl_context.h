// OpenGL without a window, with the runtime on it.
#pragma once
#include "cli/gl_handles.h"
#include "cli/runtime_handles.h"
#include "render/egl_context.h"

namespace lightwell::cli {

/// Current on the calling thread for as long as it lives.
class GlContext {
 public:
  /// Throws UsageError when this machine gives none; `container` words the runtime's failures.
  explicit GlContext(const RuntimeContainer& container);
  lw_gl* get() const { return gl_.get(); }

 private:
  std::unique_ptr<render::EglContext> context_;
  GlHandle gl_;
};

}  // namespace lightwell::cli
