// Pictures for people: 8-bit RGBA and PNG.
#pragma once
#include <cstdint>
#include <filesystem>
#include <vector>

namespace lightwell::render {

/// sRGB-encoded RGBA, row 0 at the top; width * height * 4 bytes.
struct Image8 {
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;
};

/// Writes an RGB PNG through a temporary file in the same folder. Throws std::runtime_error naming the file.
void writePng(const std::filesystem::path& file, const Image8& image);

}  // namespace lightwell::render
