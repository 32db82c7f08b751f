// An OpenGL context without a window or a display server.
#pragma once
#include <memory>
#include <string>

namespace lightwell::render {

enum class GlApi { desktop, es };

/// A surfaceless EGL context, current on the thread that made it until it is destroyed. Needs EGL_MESA_platform_surfaceless.
class EglContext {
 public:
  /// OpenGL 3.3 core, or else OpenGL ES 3.0. Throws RenderError (LW_GL_UNSUPPORTED) when there is neither.
  EglContext();
  /// Only the given one.
  explicit EglContext(GlApi api);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  GlApi api() const { return api_; }
  /// What draws, for reports: "llvmpipe (LLVM 15.0.6, 256 bits), OpenGL 4.5 (Core Profile) …".
  std::string description() const;
  void makeCurrent();

  using Proc = void (*)();
  /// lw_gl_config::loader: the address of a GL function; `user` is not used.
  static Proc load(void* user, const char* name);

 private:
  bool create(GlApi api);
  void* display_ = nullptr;
  void* context_ = nullptr;
  GlApi api_ = GlApi::desktop;
};

}  // namespace lightwell::render
