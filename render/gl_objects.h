// Owned OpenGL names, and programs with their uniforms.
#pragma once
#include <epoxy/gl.h>

#include <string>
#include <string_view>
#include <utility>

#include "render/vector_math.h"

namespace lightwell::render {

/// A name that OpenGL made and this object deletes, in the context that is current then.
template <class Kind>
class GlObject {
 public:
  GlObject() = default;
  static GlObject make() {
    GlObject object;
    Kind::make(&object.name_);
    return object;
  }
  GlObject(GlObject&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  GlObject& operator=(GlObject&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~GlObject() {
    if (name_) Kind::destroy(&name_);
  }
  operator GLuint() const { return name_; }

 private:
  GLuint name_ = 0;
};

struct TextureKind {
  static void make(GLuint* name) { glGenTextures(1, name); }
  static void destroy(const GLuint* name) { glDeleteTextures(1, name); }
};
struct BufferKind {
  static void make(GLuint* name) { glGenBuffers(1, name); }
  static void destroy(const GLuint* name) { glDeleteBuffers(1, name); }
};
struct VertexArrayKind {
  static void make(GLuint* name) { glGenVertexArrays(1, name); }
  static void destroy(const GLuint* name) { glDeleteVertexArrays(1, name); }
};
struct FramebufferKind {
  static void make(GLuint* name) { glGenFramebuffers(1, name); }
  static void destroy(const GLuint* name) { glDeleteFramebuffers(1, name); }
};
struct RenderbufferKind {
  static void make(GLuint* name) { glGenRenderbuffers(1, name); }
  static void destroy(const GLuint* name) { glDeleteRenderbuffers(1, name); }
};
using Texture = GlObject<TextureKind>;
using Buffer = GlObject<BufferKind>;
using VertexArray = GlObject<VertexArrayKind>;
using Framebuffer = GlObject<FramebufferKind>;
using Renderbuffer = GlObject<RenderbufferKind>;

class Program {
 public:
  Program() = default;
  /// Sources without a #version line; it and the precisions are prepended as the context needs. Throws RenderError with the log.
  Program(std::string_view vertex, std::string_view fragment);
  Program(Program&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Program& operator=(Program&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Program() {
    if (name_) glDeleteProgram(name_);
  }
  GLuint name() const { return name_; }
  void use() const { glUseProgram(name_); }
  /// Uniforms of the program in use; names that the program has no use for are ignored, as OpenGL does.
  void set(const char* uniform, int value) const { glUniform1i(location(uniform), value); }
  void set(const char* uniform, float value) const { glUniform1f(location(uniform), value); }
  void set(const char* uniform, const Float3& value) const { glUniform3fv(location(uniform), 1, value.data()); }
  void set(const char* uniform, const Matrix4& value) const { glUniformMatrix4fv(location(uniform), 1, GL_FALSE, value.data()); }
  void set2(const char* uniform, float x, float y) const { glUniform2f(location(uniform), x, y); }
  void set4(const char* uniform, const float* value) const { glUniform4fv(location(uniform), 1, value); }

 private:
  GLint location(const char* uniform) const { return glGetUniformLocation(name_, uniform); }
  GLuint name_ = 0;
};

/// A 2D texture with one level. `filter`: GL_NEAREST or GL_LINEAR; clamped to its edge.
Texture makeTexture2D(GLenum internal_format, int width, int height, GLenum format, GLenum type, const void* pixels, GLint filter);

inline void bindTexture(int unit, GLenum target, GLuint texture) {
  glActiveTexture(GLenum(GL_TEXTURE0 + unit));
  glBindTexture(target, texture);
}

}  // namespace lightwell::render
