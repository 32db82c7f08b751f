#include "render/render_target.h"

#include <algorithm>

#include "render/error.h"

namespace lightwell::render {

void RenderTarget::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  width_ = width;
  height_ = height;
  GLint max_samples = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &max_samples);
  int samples = std::min(4, int(max_samples));
  while (!attach(samples)) {
    if (samples == 0) throw RenderError(LW_GL_UNSUPPORTED, "pictures of half floats cannot be drawn");
    samples = samples > 1 ? samples / 2 : 0;
  }
  resolved_ = makeTexture2D(GL_RGBA16F, width, height, GL_RGBA, GL_HALF_FLOAT, nullptr, GL_NEAREST);
  resolved_framebuffer_ = Framebuffer::make();
  glBindFramebuffer(GL_FRAMEBUFFER, resolved_framebuffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, resolved_, 0);
}

bool RenderTarget::attach(int samples) {
  while (glGetError() != GL_NO_ERROR) {}
  color_ = Renderbuffer::make();
  glBindRenderbuffer(GL_RENDERBUFFER, color_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA16F, width_, height_);
  depth_ = Renderbuffer::make();
  glBindRenderbuffer(GL_RENDERBUFFER, depth_);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH_COMPONENT24, width_, height_);
  framebuffer_ = Framebuffer::make();
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color_);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth_);
  return glGetError() == GL_NO_ERROR && glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
}

void RenderTarget::bind() const {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
}

GLuint RenderTarget::resolve() const {
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, resolved_framebuffer_);
  glBlitFramebuffer(0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  return resolved_;
}

}  // namespace lightwell::render
