// Lines of text over the picture.
#pragma once
#include <string>

#include "render/gl_objects.h"

namespace lightwell::game {

class Text {
 public:
  Text();
  /// Draws white text with a dark shade behind it; (x, y) is the upper left corner in pixels of a width × height framebuffer.
  void draw(const std::string& text, float x, float y, int width, int height, float scale);

 private:
  render::Program program_;
  render::VertexArray vertex_array_;
  render::Buffer buffer_;
};

}  // namespace lightwell::game
