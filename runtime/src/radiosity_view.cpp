#include "runtime/src/radiosity_view.h"

#include <algorithm>
#include <cmath>

namespace lightwell::runtime {
namespace {

/// A triangle's edges as functions of the pixel: edge[k] is opposite to corner k.
struct Edges {
  double corner[3][3];  // x, y, depth
  double w[3];          // of the homogeneous coordinates: the depth, or 1
  double edge[3][3];
  double determinant;

  Edges(const Surfaces& surfaces, const View& view, const uint32_t* index) {
    for (int c = 0; c < 3; ++c) {
      double offset[3];
      for (int k = 0; k < 3; ++k) offset[k] = double(surfaces.position_m[size_t(index[c]) * 3 + size_t(k)]) - view.eye_m[k];
      // right and up hold the tangent (or the half width) of the view.
      corner[c][0] = dot(offset, view.right) / dot(view.right, view.right);
      corner[c][1] = dot(offset, view.up) / dot(view.up, view.up);
      corner[c][2] = dot(offset, view.forward);
      w[c] = view.perspective ? corner[c][2] : 1.0;
    }
    for (int c = 0; c < 3; ++c) {
      const int i = (c + 1) % 3, j = (c + 2) % 3;
      const double *a = corner[i], *b = corner[j];
      edge[c][0] = a[1] * w[j] - b[1] * w[i];
      edge[c][1] = b[0] * w[i] - a[0] * w[j];
      edge[c][2] = a[0] * b[1] - b[0] * a[1];
    }
    determinant = edge[0][0] * corner[0][0] + edge[0][1] * corner[0][1] + edge[0][2] * w[0];
  }
  /// All corners beyond one side of the view.
  bool isOutside() const {
    for (int k = 0; k < 2; ++k) {
      if (corner[0][k] > w[0] && corner[1][k] > w[1] && corner[2][k] > w[2]) return true;
      if (corner[0][k] < -w[0] && corner[1][k] < -w[1] && corner[2][k] < -w[2]) return true;
    }
    return w[0] <= 0 && w[1] <= 0 && w[2] <= 0;
  }
};

/// Of a pixel centre on the edge: the same answer never comes from both sides of it.
bool ownsBorder(const double* edge, double sign) {
  const double a = sign * edge[0], b = sign * edge[1], c = sign * edge[2];
  return a > 0 || (a == 0 && (b > 0 || (b == 0 && c > 0)));
}

float wrapped(float at, uint32_t mode, float size) {
  if (mode == LW_WRAP_CLAMP) return at;
  const float period = mode == LW_WRAP_MIRROR ? 2 * size : size;
  at -= std::floor(at / period) * period;
  if (!(at >= 0 && at <= period)) return 0;  // too far away to tell
  return mode == LW_WRAP_MIRROR && at > size ? period - at : at;
}

uint32_t neighbour(int64_t at, uint32_t mode, uint32_t size) {
  if (mode == LW_WRAP_REPEAT) return uint32_t((at % int64_t(size) + int64_t(size)) % int64_t(size));
  return uint32_t(std::clamp<int64_t>(at, 0, int64_t(size) - 1));
}

}  // namespace

bool Surfaces::isOpen(const Leaf& l, const uint32_t* corners, const double* barycentrics) const {
  double s = double(l.offset);
  for (int c = 0; c < 3; ++c)
    for (size_t k = 0; k < 3; ++k) s += barycentrics[c] * double(position_m[size_t(corners[c]) * 3 + k]) * double(l.axis_per_m[k]);
  const double place = std::clamp(s, 0.0, 1.0) * l.strips;
  const uint32_t strip = std::min(uint32_t(place), l.strips - 1);
  return place - strip < double(gate_open[l.first_gate + strip]);
}

bool AlphaSurfaces::letsThrough(const uint32_t* corners, uint32_t triangle, const double* barycentrics) const {
  if (triangle_material.empty() || triangle_material[triangle] >= material.size()) return false;
  const uint32_t m = triangle_material[triangle];
  const lw_alpha_material& surface = material[m];
  float value = surface.factor;
  if (surface.texture >= 0) {
    double at[2] = {};
    for (int c = 0; c < 3; ++c)
      for (int k = 0; k < 2; ++k) at[k] += barycentrics[c] * double(uv[size_t(corners[c]) * 2 + size_t(k)]);
    const uint32_t w = surface.texture_width, h = surface.texture_height;
    const float x = std::clamp(wrapped(float(at[0]) * float(w), surface.wrap_u, float(w)), -1.0f, float(w) + 1) - 0.5f;
    const float y = std::clamp(wrapped(float(at[1]) * float(h), surface.wrap_v, float(h)), -1.0f, float(h) + 1) - 0.5f;
    const float x0 = std::floor(x), y0 = std::floor(y);
    float sum = 0;
    for (int i = 0; i < 4; ++i) {
      const float weight = (i & 1 ? x - x0 : 1 - (x - x0)) * (i >> 1 ? y - y0 : 1 - (y - y0));
      const uint32_t column = neighbour(int64_t(x0) + (i & 1), surface.wrap_u, w), row = neighbour(int64_t(y0) + (i >> 1), surface.wrap_v, h);
      sum += weight * float(alpha[first_alpha[m] + size_t(row) * w + column]);
    }
    value *= sum / 255;
  }
  return value < (surface.mode == LW_ALPHA_MASK ? surface.cutoff : 0.5f);
}

void ViewRaster::draw(const Surfaces& surfaces, const View& view) {
  std::fill(triangle_.begin(), triangle_.end(), kNothing);
  std::fill(nearness_.begin(), nearness_.end(), view.perspective ? 0.0 : -HUGE_VAL);
  for (uint32_t t = 0; t < surfaces.triangles(); ++t) drawTriangle(surfaces, view, t);
}

void ViewRaster::drawTriangle(const Surfaces& surfaces, const View& view, uint32_t triangle) {
  const uint32_t* index = &surfaces.index[size_t(triangle) * 3];
  const Edges e(surfaces, view, index);
  if (e.isOutside() || e.determinant == 0 || !std::isfinite(e.determinant)) return;
  const double sign = e.determinant > 0 ? 1 : -1;
  // The pixels around it; all of them when it reaches behind the eye.
  uint32_t begin[2] = {0, 0}, end[2] = {side_, side_};
  if (e.w[0] > 0 && e.w[1] > 0 && e.w[2] > 0)
    for (int k = 0; k < 2; ++k) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (int c = 0; c < 3; ++c) low = std::min(low, e.corner[c][k] / e.w[c]), high = std::max(high, e.corner[c][k] / e.w[c]);
      begin[k] = uint32_t(std::clamp(std::floor((low + 1) * 0.5 * side_ - 0.5) - 1, 0.0, double(side_)));
      end[k] = uint32_t(std::clamp(std::ceil((high + 1) * 0.5 * side_ - 0.5) + 2, 0.0, double(side_)));
    }
  bool owns[3];
  for (int c = 0; c < 3; ++c) owns[c] = ownsBorder(e.edge[c], sign);
  const bool alpha = !surfaces.alpha.triangle_material.empty() && surfaces.alpha.triangle_material[triangle] != 0xffff;
  const Leaf* leaf = surfaces.leafOf(triangle);
  for (uint32_t j = begin[1]; j < end[1]; ++j) {
    double row[3];
    for (int c = 0; c < 3; ++c) row[c] = e.edge[c][1] * center(j) + e.edge[c][2];
    for (uint32_t i = begin[0]; i < end[0]; ++i) {
      double value[3];
      bool inside = true;
      for (int c = 0; c < 3; ++c) {
        value[c] = e.edge[c][0] * center(i) + row[c];
        inside &= value[c] * sign > 0 || (value[c] == 0 && owns[c]);
      }
      if (!inside) continue;
      const double sum = value[0] + value[1] + value[2];
      const double barycentrics[3] = {value[0] / sum, value[1] / sum, value[2] / sum};
      const double nearness = view.perspective ? sum / e.determinant
                                               : -(barycentrics[0] * e.corner[0][2] + barycentrics[1] * e.corner[1][2] + barycentrics[2] * e.corner[2][2]);
      const size_t pixel = size_t(j) * side_ + i;
      if (!(nearness > nearness_[pixel])) continue;
      if (leaf && surfaces.isOpen(*leaf, index, barycentrics)) continue;
      if (alpha && surfaces.alpha.letsThrough(index, triangle, barycentrics)) continue;
      nearness_[pixel] = nearness;
      triangle_[pixel] = triangle;
    }
  }
}

double ViewRaster::placeAt(const Surfaces& surfaces, const View& view, uint32_t i, uint32_t j, double* barycentrics) const {
  const Edges e(surfaces, view, &surfaces.index[size_t(triangleAt(i, j)) * 3]);
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += barycentrics[c] = e.edge[c][0] * center(i) + (e.edge[c][1] * center(j) + e.edge[c][2]);
  for (int c = 0; c < 3; ++c) barycentrics[c] /= sum;
  const double nearness = nearness_[size_t(j) * side_ + i];
  return view.perspective ? 1 / nearness : -nearness;
}

}  // namespace lightwell::runtime
