#include "samples/common/contact_sheet.h"

#include <algorithm>
#include <cmath>

namespace lightwell::samples {

using render::Image8;

Image8 reduced(const Image8& image, int factor) {
  Image8 small{image.width / factor, image.height / factor, {}};
  const float gamma = 2.2f;
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x)
      for (int c = 0; c < 4; ++c) {
        float sum = 0;
        for (int k = 0; k < factor * factor; ++k) {
          const size_t pixel = size_t(y * factor + k / factor) * size_t(image.width) + size_t(x * factor + k % factor);
          sum += std::pow(float(image.rgba[pixel * 4 + size_t(c)]) / 255, gamma);
        }
        small.rgba.push_back(uint8_t(std::lround(255 * std::pow(sum / float(factor * factor), 1 / gamma))));
      }
  return small;
}

Image8 contactSheet(const std::vector<Image8>& images, int columns) {
  const int gap = 4, width = images[0].width, height = images[0].height, rows = int(images.size()) / columns;
  Image8 sheet{columns * (width + gap) - gap, rows * (height + gap) - gap, {}};
  sheet.rgba.assign(size_t(sheet.width) * size_t(sheet.height) * 4, 255);
  for (int i = 0; i < int(images.size()); ++i)
    for (int y = 0; y < height; ++y) {
      const size_t to = size_t(i / columns * (height + gap) + y) * size_t(sheet.width) + size_t(i % columns * (width + gap));
      std::copy_n(images[size_t(i)].rgba.begin() + long(y) * width * 4, width * 4, sheet.rgba.begin() + long(to) * 4);
    }
  return sheet;
}

}  // namespace lightwell::samples
