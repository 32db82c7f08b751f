// Whose light it is that a visible point receives.
#include <algorithm>
#include <cmath>

#include "runtime/src/container.h"
#include "runtime/src/radiosity_injector.h"

namespace lightwell::runtime {
namespace {

/// 0 for what is no number.
uint32_t texelAt(double uv, uint32_t size) { return uv * size >= 1 ? uint32_t(std::min(uv * size, double(size - 1))) : 0; }

}  // namespace

uint32_t PatchFinder::patchOf(uint32_t texel, bool front) const {
  const uint32_t value = i_.value_of_texel[texel];
  if (value == kNone) return kNone;
  if (front) return r_.texel_patch[size_t(value) * 4];
  return r_.texel_back_patch.empty() ? kNone : r_.texel_back_patch[value];
}

void PatchFinder::normalOf(uint32_t triangle, bool front, double* normal) const {
  const uint32_t* index = &i_.surfaces.index[size_t(triangle) * 3];
  const float* p[3];
  for (int c = 0; c < 3; ++c) p[c] = &i_.surfaces.position_m[size_t(index[c]) * 3];
  double a[3], b[3];
  for (int k = 0; k < 3; ++k) {
    a[k] = double(p[1][k]) - double(p[0][k]);
    b[k] = double(p[2][k]) - double(p[0][k]);
  }
  for (int k = 0; k < 3; ++k) normal[k] = (a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3]) * (front ? 1 : -1);
}

bool PatchFinder::faces(uint32_t patch, const double* normal) const {
  double cosine = 0;
  for (int k = 0; k < 3; ++k) cosine += normal[k] * double(r_.patch_normal[size_t(patch) * 3 + size_t(k)]);
  return cosine > 0;
}

uint32_t PatchFinder::patchNear(uint32_t x, uint32_t y, bool front, const double* normal) const {
  const uint32_t own = patchOf(y * r_.width + x, front);
  if (own != kNone) return own;
  // A sliver's texel, or one that is mostly behind something: what little is seen of it belongs to its neighbour.
  constexpr uint32_t kReach = kPatchNeighbourhood;
  uint32_t best = kNone, best_distance = 2 * kReach * kReach + 1;
  for (uint32_t v = y - std::min(y, kReach); v <= std::min(y + kReach, r_.height - 1); ++v)
    for (uint32_t u = x - std::min(x, kReach); u <= std::min(x + kReach, r_.width - 1); ++u) {
      const uint32_t distance = (u > x ? u - x : x - u) * (u > x ? u - x : x - u) + (v > y ? v - y : y - v) * (v > y ? v - y : y - v);
      const uint32_t patch = distance < best_distance ? patchOf(v * r_.width + u, front) : kNone;
      if (patch != kNone && faces(patch, normal)) best = patch, best_distance = distance;
    }
  return best;
}

uint32_t PatchFinder::patchAt(uint32_t triangle, bool front, const double* normal, const double* uv) {
  if (!front && !(i_.flags[triangle] & LW_TRIANGLE_DOUBLE_SIDED)) return kNone;  // absorbed
  const uint32_t near = patchNear(texelAt(uv[0], r_.width), texelAt(uv[1], r_.height), front, normal);
  return near != kNone ? near : nearestTo(triangle, front, normal);
}

/// The patch nearest to the triangle's centre that faces the same way.
uint32_t PatchFinder::nearestTo(uint32_t triangle, bool front, const double* normal) {
  uint32_t& known = i_.nearest_patch[size_t(triangle) * 2 + !front];
  if (known != kUnknownPatch) return known;
  double center_m[3] = {}, least = HUGE_VAL;
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 3; ++k) center_m[k] += double(i_.surfaces.position_m[size_t(i_.surfaces.index[size_t(triangle) * 3 + size_t(c)]) * 3 + size_t(k)]) / 3;
  known = kNone;
  for (uint32_t p = 0; p < r_.patches(); ++p) {
    double square = 0;
    for (int k = 0; k < 3; ++k) square += std::pow(double(r_.patch_position_m[size_t(p) * 3 + size_t(k)]) - center_m[k], 2);
    if (square < least && faces(p, normal)) least = square, known = p;
  }
  return known;
}

bool PatchFinder::needsNearest(uint32_t triangle, bool front, const double* normal) const {
  uint32_t begin[2] = {r_.width, r_.height}, last[2] = {};
  for (int c = 0; c < 3; ++c)
    for (int k = 0; k < 2; ++k) {
      const uint32_t at = texelAt(double(i_.lightmap_uv[size_t(i_.surfaces.index[size_t(triangle) * 3 + size_t(c)]) * 2 + size_t(k)]), k ? r_.height : r_.width);
      begin[k] = std::min(begin[k], at), last[k] = std::max(last[k], at);
    }
  for (uint32_t y = begin[1]; y <= last[1]; ++y)
    for (uint32_t x = begin[0]; x <= last[0]; ++x)
      if (patchNear(x, y, front, normal) == kNone) return true;
  return false;
}

void PatchFinder::findNearest() {
  for (uint32_t t = 0; t < i_.surfaces.triangles(); ++t)
    for (const bool front : {true, false}) {
      double normal[3];
      normalOf(t, front, normal);
      if ((front || i_.flags[t] & LW_TRIANGLE_DOUBLE_SIDED) && needsNearest(t, front, normal))
        nearestTo(t, front, normal);
      else
        i_.nearest_patch[size_t(t) * 2 + !front] = kNone;
    }
}

}  // namespace lightwell::runtime
