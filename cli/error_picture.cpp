#include "cli/error_picture.h"

#include <algorithm>
#include <cmath>

#include "precompute/core/math.h"

namespace lightwell::cli {
namespace {

constexpr int kLeastPixels = 512;   // along a side
constexpr double kEnhanced = 5;     // of the rms of the reference

bool covered(const float* texel) { return texel[3] > 0; }
double brightness(const float* texel) { return double(luminance({texel[0], texel[1], texel[2]})); }

}  // namespace

render::Image8 errorPicture(const ImageRgba& first_reference, const ImageRgba* second_reference, const ImageRgba& candidate) {
  ImageRgba reference = first_reference;
  if (second_reference)
    for (size_t i = 0; i < reference.pixels.size(); ++i)
      for (size_t k = 0; k < 3; ++k) reference.pixels[i][k] = 0.5f * (reference.pixels[i][k] + second_reference->pixels[i][k]);
  const int zoom = std::max(1, kLeastPixels / std::max({reference.width, reference.height, 1}));
  render::Image8 picture{reference.width * zoom, reference.height * zoom, {}};
  picture.rgba.resize(size_t(picture.width) * size_t(picture.height) * 4);
  const auto texel = [](const ImageRgba& image, int x, int y) { return image.pixels[size_t(y) * size_t(image.width) + size_t(x)].data(); };
  double squares = 0, count = 0;
  for (int y = 0; y < reference.height; ++y)
    for (int x = 0; x < reference.width; ++x)
      if (const float* r = texel(reference, x, y); covered(r)) squares += brightness(r) * brightness(r), ++count;
  const double rms = count > 0 ? std::sqrt(squares / count) : 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const float *r = texel(reference, x / zoom, y / zoom), *c = texel(candidate, x / zoom, y / zoom);
      uint8_t rgb[3] = {128, 128, 128};
      if (covered(r) && covered(c)) {
        const double difference = brightness(c) - brightness(r), error = difference == 0 ? 0 : std::isfinite(difference) ? std::clamp(kEnhanced * difference / rms, -1.0, 1.0) : 1.0;
        const auto less = uint8_t(std::lround(255 * (1 - std::abs(error))));
        rgb[0] = error < 0 ? less : 255, rgb[1] = less, rgb[2] = error > 0 ? less : 255;
      }
      uint8_t* pixel = &picture.rgba[(size_t(y) * size_t(picture.width) + size_t(x)) * 4];
      std::copy_n(rgb, 3, pixel);
      pixel[3] = 255;
    }
  return picture;
}

}  // namespace lightwell::cli
