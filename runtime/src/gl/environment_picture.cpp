// The picture of a sky that shaders look up: lobes of a series of shininesses, integrated once at load time.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/environment.h"
#include "runtime/src/gl/environment_gl.h"

namespace lightwell::runtime::gl {
namespace {

// Spacing of the integrated nodes over the lobe's deviation 1/√n. Cubic interpolation halves it; a linear filter between fitted values then is
// within 1 % of a single bright point, and of less of a real sky.
constexpr float kNodeRatio = 0.65f;
// Between integrated nodes along a face. The cosine has an edge at the horizon: 16 cells are 0.5 % off on a plane with lamps all around at its
// height.
constexpr uint32_t kFewestCells = 8, kCosineCells = 48;
constexpr double kPi = 3.14159265358979323846;

uint32_t cellsFor(float shininess) {
  return std::max(shininess > 1 ? kFewestCells : kCosineCells, uint32_t(std::ceil(0.5 * kPi * std::sqrt(double(shininess)) / kNodeRatio)));
}

/// Unit direction at the equal angles of face coordinates in [0, cells]: axis ±x, ±y, ±z, then the two next axes in cyclic order.
void faceDirection(uint32_t face, uint32_t x, uint32_t y, uint32_t cells, float* direction) {
  const auto tangent = [&](uint32_t i) { return std::tan((2.0 * i / cells - 1) * kPi / 4); };
  const double a = tangent(x), b = tangent(y), scale = 1 / std::sqrt(1 + a * a + b * b);
  const uint32_t axis = face / 2;
  direction[axis] = float(face % 2 == 0 ? scale : -scale);
  direction[(axis + 1) % 3] = float(a * scale);
  direction[(axis + 2) % 3] = float(b * scale);
}

/// Doubles a line of `count` values: cubic between four, at the ends of the line from one side.
void refineLine(float* values, uint32_t count, size_t stride) {
  const auto coarse = [&](uint32_t i) { return values[size_t(2 * i) * stride]; };
  for (uint32_t i = 0; i + 1 < count; ++i) {
    float& middle = values[size_t(2 * i + 1) * stride];
    if (i == 0) middle = 0.3125f * coarse(0) + 0.9375f * coarse(1) - 0.3125f * coarse(2) + 0.0625f * coarse(3);
    else if (i + 2 == count)
      middle = 0.3125f * coarse(i + 1) + 0.9375f * coarse(i) - 0.3125f * coarse(i - 1) + 0.0625f * coarse(i - 2);
    else middle = 0.5625f * (coarse(i) + coarse(i + 1)) - 0.0625f * (coarse(i - 1) + coarse(i + 2));
  }
}

/// Makes the values of nodes, which a linear filter would understate at every peak, those of the line that is closest to the smooth function in
/// the mean: f − h² f'' / 12. The ends stay: faces share them.
void fitToLinearFilter(float* values, uint32_t count, size_t stride) {
  float before = values[0];
  for (uint32_t i = 1; i + 1 < count; ++i) {
    float& value = values[size_t(i) * stride];
    const float here = value;
    value -= (before - 2 * here + values[size_t(i + 1) * stride]) / 12;
    before = here;
  }
}

/// Mean radiance under the lobe at the nodes of one face, [2 cells + 1]²[3].
void integrateFace(const lw_environment& environment, float shininess, uint32_t face, uint32_t cells, float* rgb) {
  const size_t side = 2 * cells + 1;
  const double scale = (double(shininess) + 1) / (2 * kPi);
  for (uint32_t y = 0; y <= cells; ++y)
    for (uint32_t x = 0; x <= cells; ++x) {
      float direction[3];
      double sum[3] = {};
      faceDirection(face, x, y, cells, direction);
      environment.sky.addIntegral(direction, shininess, sum, SkyLevels::kFinestRatio);
      for (size_t c = 0; c < 3; ++c) rgb[(size_t(2 * y) * side + 2 * x) * 3 + c] = float(sum[c] * scale);
    }
  for (size_t c = 0; c < 3; ++c) {
    for (uint32_t y = 0; y <= cells; ++y) refineLine(rgb + size_t(2 * y) * side * 3 + c, cells + 1, 3);
    for (size_t x = 0; x < side; ++x) refineLine(rgb + x * 3 + c, cells + 1, side * 3);
    for (size_t y = 0; y < side; ++y) fitToLinearFilter(rgb + y * side * 3 + c, uint32_t(side), 3);
    for (size_t x = 0; x < side; ++x) fitToLinearFilter(rgb + x * 3 + c, uint32_t(side), side * 3);
  }
}

}  // namespace

bool makeSkyPicture(const Host& host, const lw_environment& environment, SkyPicture& picture) {
  // A geometric series from 1 to the sharpest that the nodes resolve, in steps of at most 2.
  const float sharpest = std::max(environment.sky.maxShininess(), 1.01f);
  const float log_sharpest = std::log(sharpest);
  picture.levels = std::clamp(uint32_t(std::ceil(std::log2(sharpest))) + 1, 4u, kSkyLevels);
  float shininess[kSkyLevels];
  int32_t side[kSkyLevels];
  for (uint32_t l = 0; l < picture.levels; ++l) {
    shininess[l] = l + 1 == picture.levels ? sharpest : std::exp(log_sharpest * float(l) / float(picture.levels - 1));
    side[l] = int32_t(2 * cellsFor(shininess[l]) + 1);
  }
  // Sharp levels first, in rows as wide as two of the largest: the sharpest, or the cosine's where nodes are few.
  const uint32_t last = picture.levels - 1;
  const int32_t largest_side = *std::max_element(side, side + picture.levels);
  picture.width = 2 * largest_side;
  int32_t x = 0, y = 0, row_height = 0;
  for (uint32_t l = picture.levels; l-- > 0;) {
    if (x + side[l] > picture.width) {
      x = 0;
      y += row_height;
      row_height = 0;
    }
    picture.level[l] = {float(x), float(y), float(side[l] - 1), l == last ? log_sharpest : 0.0f};
    x += side[l];
    row_height = std::max(row_height, side[l]);
  }
  picture.height = y + row_height;

  const size_t layer = size_t(picture.width) * size_t(picture.height);
  Array<float> rgb;
  if (!rgb.allocate(host, layer * 18) || !picture.texels.allocate(host, layer * 6)) return false;
  std::memset(rgb.data(), 0, rgb.bytes());
  Array<float> face_rgb;
  if (!face_rgb.allocate(host, size_t(largest_side) * size_t(largest_side) * 3)) return false;
  float largest = 0;
  for (uint32_t l = 0; l < picture.levels; ++l)
    for (uint32_t face = 0; face < 6; ++face) {
      integrateFace(environment, shininess[l], face, uint32_t(side[l] - 1) / 2, face_rgb.data());
      const size_t row = size_t(side[l]) * 3;
      for (size_t v = 0; v < size_t(side[l]); ++v)
        std::memcpy(&rgb[(face * layer + (size_t(picture.level[l].y) + v) * size_t(picture.width) + size_t(picture.level[l].x)) * 3],
                    &face_rgb[v * row], row * sizeof(float));
      for (size_t i = 0; i < row * size_t(side[l]); ++i) largest = std::max(largest, face_rgb[i]);
    }
  picture.scale = largest > 0 ? std::exp2(std::ceil(std::log2(largest)) - 15) : 1.0f;
  const float to_texel = 1 / picture.scale;
  for (size_t i = 0; i < picture.texels.size(); ++i)
    picture.texels[i] = format::packRgb9e5({rgb[i * 3] * to_texel, rgb[i * 3 + 1] * to_texel, rgb[i * 3 + 2] * to_texel});
  return true;
}

}  // namespace lightwell::runtime::gl
