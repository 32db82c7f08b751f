#include "cli/report/pictures.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "cli/error_picture.h"
#include "cli/report/ladder.h"

namespace lightwell::report {
namespace {

namespace fs = std::filesystem;

constexpr int kNear = 24;        // texels along the zoomed part
constexpr int kPixels = 512;     // along a picture, about
constexpr double kWhite = 0.98;  // of texels are darker than white

ImageRgba meanOf(const Truth& truth) {
  ImageRgba mean = truth.first;
  for (size_t i = 0; i < mean.pixels.size(); ++i)
    for (size_t c = 0; c < 3; ++c) mean.pixels[i][c] = 0.5f * (mean.pixels[i][c] + truth.second.pixels[i][c]);
  return mean;
}

/// The radiance that is shown white, of the reference.
float whiteOf(const ImageRgba& image) {
  std::vector<float> values;
  for (const auto& p : image.pixels)
    if (p[3] > 0.5f) values.push_back(std::max({p[0], p[1], p[2]}));
  if (values.empty()) return 1;
  const auto at = values.begin() + std::ptrdiff_t(kWhite * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at > 0 ? *at : 1;
}

uint8_t srgb(float linear) {
  const float x = std::clamp(linear, 0.0f, 1.0f);
  return uint8_t(std::lround(255 * (x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1 / 2.4f) - 0.055f)));
}

render::Image8 shown(const ImageRgba& image, float white) {
  const int zoom = std::max(1, kPixels / std::max(image.width, image.height));
  render::Image8 picture{image.width * zoom, image.height * zoom, {}};
  picture.rgba.resize(size_t(picture.width) * size_t(picture.height) * 4);
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto& p = image.pixels[size_t(y / zoom) * size_t(image.width) + size_t(x / zoom)];
      uint8_t* pixel = &picture.rgba[(size_t(y) * size_t(picture.width) + size_t(x)) * 4];
      for (size_t c = 0; c < 3; ++c) pixel[c] = p[3] > 0 ? srgb(p[c] / white) : 128;
      pixel[3] = 255;
    }
  return picture;
}

ImageRgba cropped(const ImageRgba& image, int x, int y) {
  const int width = std::min(kNear, image.width), height = std::min(kNear, image.height);
  const int left = std::clamp(x - width / 2, 0, image.width - width), top = std::clamp(y - height / 2, 0, image.height - height);
  ImageRgba part{width, height, {}};
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) part.pixels.push_back(image.pixels[size_t(top + row) * size_t(image.width) + size_t(left + column)]);
  return part;
}

/// Of an error picture of the whole atlas, which has `zoom` pixels a texel.
render::Image8 croppedError(const render::Image8& picture, int texels, int x, int y) {
  const int zoom = picture.width / texels, size = std::min(kNear, texels);
  const int left = std::clamp(x - size / 2, 0, texels - size), top = std::clamp(y - size / 2, 0, texels - size), larger = std::max(1, kPixels / size);
  render::Image8 part{size * larger, size * larger, {}};
  part.rgba.resize(size_t(part.width) * size_t(part.height) * 4);
  for (int row = 0; row < part.height; ++row)
    for (int column = 0; column < part.width; ++column) {
      const size_t from = (size_t((top + row / larger) * zoom) * size_t(picture.width) + size_t((left + column / larger) * zoom)) * 4;
      std::copy_n(&picture.rgba[from], 4, &part.rgba[(size_t(row) * size_t(part.width) + size_t(column)) * 4]);
    }
  return part;
}

}  // namespace

std::vector<Picture> makePictures(const fs::path& folder, const Report& report, const Truth& truth) {
  fs::create_directories(folder / "pictures");
  const ImageRgba reference = meanOf(truth);
  const float white = whiteOf(reference);
  const auto write = [&](const std::string& name, const render::Image8& image) {
    const std::string file = "pictures/" + name + ".png";
    render::writePng(folder / file, image);
    return file;
  };
  std::vector<Picture> pictures;
  const std::string reference_file = write("reference", shown(reference, white));
  for (const Series& series : allSeries()) {
    const Baked* best = nullptr;
    for (const Baked& baked : report.bakes)
      if (baked.series == series.name && !baked.evaluated.empty() && (!best || baked.evaluated[0].relrmse < best->evaluated[0].relrmse)) best = &baked;
    if (!best) continue;
    ImageRgba map;
    try {
      map = readExr(folder / best->evaluated[0].map);
    } catch (const InputError&) {
      continue;
    }
    const auto [x, y] = worstTexel(truth, map);
    if (x < 0) continue;
    const std::string name(series.name);
    const render::Image8 error = cli::errorPicture(truth.first, &truth.second, map);
    pictures.push_back({std::string(series.title) + ", " + best->setting + (best->evaluated[0].variant.empty() ? "" : ", " + best->evaluated[0].variant), reference_file, write(name, shown(map, white)),
                        write(name + "_error", error), write(name + "_worst_reference", shown(cropped(reference, x, y), white)), write(name + "_worst", shown(cropped(map, x, y), white)),
                        write(name + "_worst_error", croppedError(error, map.width, x, y)), x, y, best->evaluated[0].max});
  }
  return pictures;
}

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t word = uint32_t(uint8_t(bytes[i])) << 16;
    if (i + 1 < bytes.size()) word |= uint32_t(uint8_t(bytes[i + 1])) << 8;
    if (i + 2 < bytes.size()) word |= uint8_t(bytes[i + 2]);
    text += kDigits[word >> 18], text += kDigits[word >> 12 & 63];
    text += i + 1 < bytes.size() ? kDigits[word >> 6 & 63] : '=';
    text += i + 2 < bytes.size() ? kDigits[word & 63] : '=';
  }
  return text;
}

std::string dataUri(const fs::path& png) {
  std::ifstream in(png, std::ios::binary);
  if (!in) throw std::runtime_error("cannot read " + png.string());
  const std::string bytes{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return "data:image/png;base64," + base64(bytes);
}

}  // namespace lightwell::report
