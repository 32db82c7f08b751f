#include "render/png.h"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#include <stb_image_write.h>

#include <fstream>
#include <stdexcept>
#include <string>

namespace lightwell::render {

void writePng(const std::filesystem::path& file, const Image8& image) {
  std::vector<uint8_t> rgb;
  rgb.reserve(image.rgba.size() / 4 * 3);
  for (size_t i = 0; i < image.rgba.size(); ++i)
    if (i % 4 != 3) rgb.push_back(image.rgba[i]);
  std::vector<char> png;
  const auto append = [](void* bytes, void* data, int size) {
    auto* out = static_cast<std::vector<char>*>(bytes);
    out->insert(out->end(), static_cast<char*>(data), static_cast<char*>(data) + size);
  };
  if (!stbi_write_png_to_func(append, &png, image.width, image.height, 3, rgb.data(), image.width * 3))
    throw std::runtime_error(file.string() + ": the picture cannot be encoded");
  const std::filesystem::path temporary = file.string() + ".tmp";
  std::ofstream out(temporary, std::ios::binary);
  out.write(png.data(), std::streamsize(png.size()));
  out.close();
  std::error_code error;
  if (out) std::filesystem::rename(temporary, file, error);
  if (!out || error) {
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    throw std::runtime_error(file.string() + ": cannot be written" + (error ? ": " + error.message() : ""));
  }
}

}  // namespace lightwell::render
