// A GL context without a window system, current while it lives.
#pragma once
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdlib>

#include "lightwell/lightwell_gl.h"

namespace lightwell::test {

enum class Api { desktop33, embedded30 };

class GlContext {
 public:
  explicit GlContext(Api api) {
    // The least versions that the library supports, not the newest of the driver.
    setenv("MESA_GL_VERSION_OVERRIDE", "3.3", 1);
    setenv("MESA_GLES_VERSION_OVERRIDE", "3.0", 1);
    display_ = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
    if (!display_ || !eglInitialize(display_, nullptr, nullptr)) return;
    eglBindAPI(api == Api::desktop33 ? EGL_OPENGL_API : EGL_OPENGL_ES_API);
    const EGLint desktop[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
                              EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    const EGLint embedded[] = {EGL_CONTEXT_MAJOR_VERSION, 3, EGL_CONTEXT_MINOR_VERSION, 0, EGL_NONE};
    context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, api == Api::desktop33 ? desktop : embedded);
    good_ = context_ && eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_);
  }
  ~GlContext() {
    if (!display_) return;
    eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (context_) eglDestroyContext(display_, context_);
  }
  GlContext(const GlContext&) = delete;
  GlContext& operator=(const GlContext&) = delete;
  bool good() const { return good_; }

  static lw_gl_proc load(void*, const char* name) { return reinterpret_cast<lw_gl_proc>(eglGetProcAddress(name)); }

 private:
  EGLDisplay display_ = nullptr;
  EGLContext context_ = nullptr;
  bool good_ = false;
};

}  // namespace lightwell::test
