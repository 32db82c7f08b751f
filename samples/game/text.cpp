#include "samples/game/text.h"

// stb's header has functions that we do not call.
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_easy_font.h>
#pragma GCC diagnostic pop

#include <vector>

namespace lightwell::game {
namespace {

constexpr const char* kVertex = R"(
layout(location = 0) in vec2 pixel;
uniform vec2 size, offset;
uniform float scale;
void main() {
  vec2 p = (pixel * scale + offset) / size * 2.0 - 1.0;
  gl_Position = vec4(p.x, -p.y, 0.0, 1.0);
}
)";
constexpr const char* kFragment = R"(
uniform float brightness;
out vec4 color;
void main() { color = vec4(vec3(brightness), 1.0); }
)";

struct EasyFontVertex {
  float x, y, z;
  unsigned char color[4];
};

}  // namespace

Text::Text() : program_(kVertex, kFragment), vertex_array_(render::VertexArray::make()), buffer_(render::Buffer::make()) {
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 0, nullptr);
  glBindVertexArray(0);
}

void Text::draw(const std::string& text, float x, float y, int width, int height, float scale) {
  std::vector<EasyFontVertex> corners(text.size() * 64 + 64);
  std::string copy = text;  // the header takes a char *
  const int quads = stb_easy_font_print(0, 0, copy.data(), nullptr, corners.data(), int(corners.size() * sizeof(EasyFontVertex)));
  std::vector<float> triangles;
  for (int quad = 0; quad < quads; ++quad)
    for (int corner : {0, 1, 2, 0, 2, 3}) {
      const EasyFontVertex& v = corners[size_t(quad * 4 + corner)];
      triangles.insert(triangles.end(), {v.x, v.y});
    }
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ARRAY_BUFFER, buffer_);
  glBufferData(GL_ARRAY_BUFFER, GLsizeiptr(triangles.size() * sizeof(float)), triangles.data(), GL_STREAM_DRAW);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  program_.use();
  program_.set2("size", float(width), float(height));
  program_.set("scale", scale);
  for (const float shade : {1.0f, 0.0f}) {
    program_.set("brightness", 1 - shade);
    program_.set2("offset", x + shade * scale * 0.7f, y + shade * scale * 0.7f);
    glDrawArrays(GL_TRIANGLES, 0, GLsizei(triangles.size() / 2));
  }
  glBindVertexArray(0);
}

}  // namespace lightwell::game
