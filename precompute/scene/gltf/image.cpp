#include "precompute/scene/gltf/image.h"

#include <webp/decode.h>

#include <algorithm>
#include <array>
#include <climits>
#include <cstdlib>
#include <memory>

#include "precompute/scene/gltf/jpeg_tables.h"
#include "precompute/scene/gltf/limits.h"

// Only the two formats of glTF: what is not compiled cannot be attacked.
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_STDIO
#define STBI_FAILURE_USERMSG
#define STBI_MAX_DIMENSIONS 0x7fffffff  // ours is kMaxTextureSide, with a reason
// Zeroed: stb_image of 2022 reads tables and planes of a damaged JPEG that nothing has written. Zeros are in bounds, and the same each time.
#define STBI_MALLOC(size) std::calloc(1, size)
#define STBI_REALLOC(block, size) std::realloc(block, size)
#define STBI_FREE(block) std::free(block)
#define STB_IMAGE_STATIC
#define STB_IMAGE_IMPLEMENTATION
#include <stb/stb_image.h>

namespace lightwell::scene::gltf {
namespace {

bool startsWith(std::span<const uint8_t> bytes, std::initializer_list<uint8_t> prefix) {
  return bytes.size() >= prefix.size() && std::equal(prefix.begin(), prefix.end(), bytes.begin());
}

bool isWebp(std::span<const uint8_t> bytes) {
  return bytes.size() >= 12 && startsWith(bytes, {'R', 'I', 'F', 'F'}) && startsWith(bytes.subspan(8), {'W', 'E', 'B', 'P'});
}

bool sizeAllowed(int width, int height, uint64_t max_pixels, std::string& reason) {
  if (width > 0 && height > 0 && width <= kMaxTextureSide && height <= kMaxTextureSide && uint64_t(width) * uint64_t(height) <= max_pixels)
    return true;
  reason = "has " + std::to_string(width) + " x " + std::to_string(height) + " pixels; a side may have " + std::to_string(kMaxTextureSide) + ", and all pictures together " +
           std::to_string(kMaxTexturePixels) + ", of which " + std::to_string(max_pixels) + " are left";
  return false;
}

bool decodeWebp(std::span<const uint8_t> bytes, uint64_t max_pixels, Image& image, std::string& reason) {
  if (!WebPGetInfo(bytes.data(), bytes.size(), &image.width, &image.height)) {
    reason = "is a damaged WebP picture";
    return false;
  }
  if (!sizeAllowed(image.width, image.height, max_pixels, reason)) return false;
  image.rgba.resize(size_t(image.width) * size_t(image.height) * 4);
  if (WebPDecodeRGBAInto(bytes.data(), bytes.size(), image.rgba.data(), image.rgba.size(), image.width * 4) != nullptr) return true;
  reason = "is a damaged WebP picture";
  return false;
}

bool decodeStb(std::span<const uint8_t> bytes, uint64_t max_pixels, Image& image, std::string& reason) {
  int channels = 0;
  const int length = int(std::min<size_t>(bytes.size(), INT_MAX));
  if (!stbi_info_from_memory(bytes.data(), length, &image.width, &image.height, &channels)) {
    reason = std::string("is a damaged picture: ") + stbi_failure_reason();
    return false;
  }
  if (!sizeAllowed(image.width, image.height, max_pixels, reason)) return false;
  const std::unique_ptr<stbi_uc, void (*)(void*)> pixels(
      stbi_load_from_memory(bytes.data(), length, &image.width, &image.height, &channels, 4), stbi_image_free);
  if (!pixels) {
    reason = std::string("is a damaged picture: ") + stbi_failure_reason();
    return false;
  }
  image.rgba.assign(pixels.get(), pixels.get() + size_t(image.width) * size_t(image.height) * 4);
  return true;
}

}  // namespace

bool decodeImage(std::span<const uint8_t> bytes, uint64_t max_pixels, Image& image, std::string& reason) {
  if (isWebp(bytes)) return decodeWebp(bytes, max_pixels, image, reason);
  if (startsWith(bytes, {0x89, 'P', 'N', 'G'})) return decodeStb(bytes, max_pixels, image, reason);
  if (startsWith(bytes, {0xFF, 0xD8, 0xFF})) {
    const std::string defect = jpegTableDefect(bytes);
    if (defect.empty()) return decodeStb(bytes, max_pixels, image, reason);
    reason = "is a damaged picture: " + defect;
    return false;
  }
  reason = "is neither PNG nor JPEG nor WebP";
  return false;
}

}  // namespace lightwell::scene::gltf
