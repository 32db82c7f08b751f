#include "render/gl_objects.h"

#include "render/error.h"

namespace lightwell::render {
namespace {

constexpr std::string_view kDesktopHeader = "#version 330 core\n";
constexpr std::string_view kEsHeader =
    "#version 300 es\nprecision highp float;\nprecision highp int;\nprecision highp sampler2D;\n"
    "precision highp sampler2DShadow;\nprecision highp samplerCubeShadow;\n";

GLuint compile(GLenum stage, std::string_view source) {
  const std::string_view header = epoxy_is_desktop_gl() ? kDesktopHeader : kEsHeader;
  const char* parts[] = {header.data(), source.data()};
  const GLint lengths[] = {GLint(header.size()), GLint(source.size())};
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 2, parts, lengths);
  glCompileShader(shader);
  GLint compiled = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled) return shader;
  char log[1024] = {};
  glGetShaderInfoLog(shader, sizeof log, nullptr, log);
  glDeleteShader(shader);
  throw RenderError(LW_GL_FAILED, std::string("a shader of the renderer does not compile: ") + log);
}

}  // namespace

Program::Program(std::string_view vertex, std::string_view fragment) {
  const GLuint vertex_shader = compile(GL_VERTEX_SHADER, vertex), fragment_shader = compile(GL_FRAGMENT_SHADER, fragment);
  name_ = glCreateProgram();
  glAttachShader(name_, vertex_shader);
  glAttachShader(name_, fragment_shader);
  glLinkProgram(name_);
  glDeleteShader(vertex_shader);
  glDeleteShader(fragment_shader);
  GLint linked = 0;
  glGetProgramiv(name_, GL_LINK_STATUS, &linked);
  if (linked) return;
  char log[1024] = {};
  glGetProgramInfoLog(name_, sizeof log, nullptr, log);
  glDeleteProgram(std::exchange(name_, 0));
  throw RenderError(LW_GL_FAILED, std::string("a program of the renderer does not link: ") + log);
}

Texture makeTexture2D(GLenum internal_format, int width, int height, GLenum format, GLenum type, const void* pixels, GLint filter) {
  Texture texture = Texture::make();
  bindTexture(0, GL_TEXTURE_2D, texture);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GLint(internal_format), width, height, 0, format, type, pixels);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAX_LEVEL, 0);
  return texture;
}

}  // namespace lightwell::render
