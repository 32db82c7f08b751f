// Where radiance is drawn before tone mapping: half floats, multisampled, resolved into a texture.
#pragma once
#include "render/gl_objects.h"

namespace lightwell::render {

class RenderTarget {
 public:
  /// (Re)makes the buffers when the size changes: up to 4 samples, as many as the implementation has. Throws RenderError.
  void resize(int width, int height);
  /// Makes it the draw framebuffer, viewport included.
  void bind() const;
  /// Averages the samples. The texture then holds the picture, row 0 at the bottom.
  GLuint resolve() const;
  /// For glReadPixels of the resolved picture.
  GLuint resolvedFramebuffer() const { return resolved_framebuffer_; }

 private:
  bool attach(int samples);
  int width_ = 0, height_ = 0;
  Renderbuffer color_, depth_;
  Framebuffer framebuffer_, resolved_framebuffer_;
  Texture resolved_;
};

}  // namespace lightwell::render
