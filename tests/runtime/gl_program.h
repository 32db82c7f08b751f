// Programs that compute one RGBA value for each element of a list of inputs, to look at exported GLSL from outside.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/runtime/gl_context.h"

namespace lightwell::test {

/// One triangle over everything, and a fragment shader of `source` behind the version line.
inline GLuint linkProgram(Api api, const std::string& source) {
  const std::string version = api == Api::desktop33 ? "#version 330 core\n" : "#version 300 es\nprecision mediump float;\n";
  const GLuint program = glCreateProgram();
  const auto add = [&](GLenum type, const std::string& text) {
    const GLuint shader = glCreateShader(type);
    const char* pointer = text.c_str();
    glShaderSource(shader, 1, &pointer, nullptr);
    glCompileShader(shader);
    GLint good = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
    char log[1000] = {};
    glGetShaderInfoLog(shader, sizeof log, nullptr, log);
    EXPECT_TRUE(good) << log;
    glAttachShader(program, shader);
    glDeleteShader(shader);
  };
  add(GL_VERTEX_SHADER, version + "void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); }");
  add(GL_FRAGMENT_SHADER, version + source);
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  EXPECT_TRUE(linked);
  return program;
}

/// Runs `expression` (a vec3 of `vec4 a, b`, the two inputs of an element, and `n`, a number) of a snippet over a list.
class ListProgram {
 public:
  ListProgram(Api api, const std::string& snippet, const std::string& expression)
      : program_(linkProgram(api, snippet + "uniform highp sampler2D u_a, u_b; uniform highp float n; out highp vec4 color;\nvoid main() {\n"
                                            "  ivec2 at = ivec2(gl_FragCoord.xy);\n"
                                            "  highp vec4 a = texelFetch(u_a, at, 0), b = texelFetch(u_b, at, 0);\n"
                                            "  color = vec4(" + expression + ", 1.0);\n}")) {}
  ~ListProgram() { glDeleteProgram(program_); }
  ListProgram(const ListProgram&) = delete;
  ListProgram& operator=(const ListProgram&) = delete;
  GLuint name() const { return program_; }

  /// [count][4] of results; a and b [count][4]. Uses the units 8 and 9.
  std::vector<float> run(const std::vector<float>& a, const std::vector<float>& b, float n) const {
    const GLsizei count = GLsizei(a.size() / 4);
    GLuint textures[3] = {}, framebuffer = 0, vertex_array = 0;
    glGenTextures(3, textures);
    const float* data[3] = {a.data(), b.data(), nullptr};
    for (GLenum t = 0; t < 3; ++t) {
      glActiveTexture(GL_TEXTURE8 + t);
      glBindTexture(GL_TEXTURE_2D, textures[t]);
      glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, count, 1, 0, GL_RGBA, GL_FLOAT, data[t]);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures[2], 0);
    glGenVertexArrays(1, &vertex_array);
    glBindVertexArray(vertex_array);
    glViewport(0, 0, count, 1);
    glUseProgram(program_);
    glUniform1i(glGetUniformLocation(program_, "u_a"), 8);
    glUniform1i(glGetUniformLocation(program_, "u_b"), 9);
    glUniform1f(glGetUniformLocation(program_, "n"), n);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    std::vector<float> pixels(size_t(count) * 4);
    glReadPixels(0, 0, count, 1, GL_RGBA, GL_FLOAT, pixels.data());
    glUseProgram(0);
    glBindVertexArray(0);
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    glDeleteFramebuffers(1, &framebuffer);
    glDeleteVertexArrays(1, &vertex_array);
    glDeleteTextures(3, textures);
    glActiveTexture(GL_TEXTURE0);
    return pixels;
  }

 private:
  GLuint program_;
};

}  // namespace lightwell::test
