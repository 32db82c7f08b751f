#include "render/egl_context.h"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include "render/error.h"

namespace lightwell::render {
namespace {

EGLDisplay openDisplay() {
  // The EXT entry point: libepoxy cannot resolve EGL 1.5's before a display exists.
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    throw RenderError(LW_GL_UNSUPPORTED, "EGL cannot draw without a surface: EGL_MESA_platform_surfaceless is missing");
  const EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr))
    throw RenderError(LW_GL_UNSUPPORTED, "EGL has no surfaceless display");
  return display;
}

}  // namespace

EglContext::EglContext() : display_(openDisplay()) {
  if (!create(GlApi::desktop) && !create(GlApi::es))
    throw RenderError(LW_GL_UNSUPPORTED, "neither OpenGL 3.3 nor OpenGL ES 3.0 is available");
}

EglContext::EglContext(GlApi api) : display_(openDisplay()) {
  if (!create(api))
    throw RenderError(LW_GL_UNSUPPORTED, api == GlApi::es ? "OpenGL ES 3.0 is not available" : "OpenGL 3.3 is not available");
}

// The display is the process's, shared by all contexts: it is not terminated.
EglContext::~EglContext() {
  if (eglGetCurrentContext() == context_) eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglDestroyContext(display_, context_);
}

bool EglContext::create(GlApi api) {
  const EGLint desktop[] = {EGL_CONTEXT_MAJOR_VERSION_KHR, 3, EGL_CONTEXT_MINOR_VERSION_KHR, 3,
                            EGL_CONTEXT_OPENGL_PROFILE_MASK_KHR, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT_KHR, EGL_NONE};
  const EGLint es[] = {EGL_CONTEXT_MAJOR_VERSION_KHR, 3, EGL_CONTEXT_MINOR_VERSION_KHR, 0, EGL_NONE};
  if (!eglBindAPI(api == GlApi::es ? EGL_OPENGL_ES_API : EGL_OPENGL_API)) return false;
  context_ = eglCreateContext(display_, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, api == GlApi::es ? es : desktop);
  if (context_ == EGL_NO_CONTEXT) return false;
  api_ = api;
  if (eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) return true;
  eglDestroyContext(display_, context_);
  return false;
}

void EglContext::makeCurrent() {
  eglBindAPI(api_ == GlApi::es ? EGL_OPENGL_ES_API : EGL_OPENGL_API);
  if (!eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_)) throw RenderError(LW_GL_FAILED, "eglMakeCurrent");
}

std::string EglContext::description() const {
  const auto text = [](GLenum name) { return std::string(reinterpret_cast<const char*>(glGetString(name))); };
  return text(GL_RENDERER) + ", " + (api_ == GlApi::desktop ? "OpenGL " : "") + text(GL_VERSION);
}

EglContext::Proc EglContext::load(void*, const char* name) { return eglGetProcAddress(name); }

}  // namespace lightwell::render
