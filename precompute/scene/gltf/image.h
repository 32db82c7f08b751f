// PNG, JPEG and WebP pictures, recognised by content.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace lightwell::scene::gltf {

/// 8-bit RGBA, row 0 on top, colours as encoded (sRGB). A grey picture has R = G = B, one without alpha A = 255.
struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;
};

/// Decodes a picture of at most `max_pixels`; on failure returns false and says why in `reason`.
bool decodeImage(std::span<const uint8_t> bytes, uint64_t max_pixels, Image& image, std::string& reason);

}  // namespace lightwell::scene::gltf
