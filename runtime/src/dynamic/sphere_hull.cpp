#include "runtime/src/dynamic/sphere_hull.h"

#include <cmath>
#include <utility>

namespace lightwell::runtime {
namespace {

constexpr double kAbove = 1e-13;       // of unit lengths: nearer to a face's plane a point lies on it
constexpr double kLeastVolume = 1e-12;

}  // namespace

bool SphereHull::allocate(const Host& host, uint32_t points) {
  return point_.allocate(host, points) && face_.allocate(host, size_t(points) * 2 + 8) && visible_.allocate(host, size_t(points) * 2 + 8) &&
         horizon_.allocate(host, (size_t(points) * 2 + 8) * 6);
}

void SphereHull::add(uint32_t a, uint32_t b, uint32_t c) {
  Face& face = face_[faces_++];
  face = {{a, b, c}, cross(point_[b] - point_[a], point_[c] - point_[a]), 0};
  const double length = std::sqrt(dot(face.normal, face.normal));
  face.normal = face.normal * (length > 0 ? 1 / length : 0);
  face.offset = dot(face.normal, point_[a]);
}

bool SphereHull::build(const Double3* points, uint32_t count) {
  points_ = count;
  faces_ = 0;
  for (uint32_t i = 0; i < count; ++i) point_[i] = points[i];
  if (count < 4) return false;
  // Four points that are far from lying in a plane.
  const auto farthest = [&](const auto& measure) {
    uint32_t best = 0;
    for (uint32_t i = 1; i < count; ++i)
      if (measure(point_[i]) > measure(point_[best])) best = i;
    return best;
  };
  const Double3 a = point_[0];
  const uint32_t second = farthest([&](Double3 p) { return dot(p - a, p - a); });
  const Double3 ab = point_[second] - a;
  const uint32_t third = farthest([&](Double3 p) { return dot(cross(ab, p - a), cross(ab, p - a)); });
  const Double3 normal = cross(ab, point_[third] - a);
  const uint32_t fourth = farthest([&](Double3 p) { return std::fabs(dot(normal, p - a)); });
  const double volume = dot(normal, point_[fourth] - a);
  if (!(std::fabs(volume) > kLeastVolume)) return false;
  uint32_t b = second, c = third;
  if (volume > 0) std::swap(b, c);
  add(0, b, c), add(0, c, fourth), add(c, b, fourth), add(b, 0, fourth);
  for (uint32_t i = 1; i < count; ++i)
    if (i != second && i != third && i != fourth) addToHull(i);
  return true;
}

void SphereHull::insert(Double3 point) {
  if (faces_ == 0 || points_ >= point_.size() || !std::isfinite(dot(point, point))) return;
  point_[points_] = point;
  addToHull(points_++);
}

void SphereHull::addToHull(uint32_t point) {
  uint32_t seen = 0;
  for (uint32_t f = 0; f < faces_; ++f)
    if (dot(face_[f].normal, point_[point]) > face_[f].offset + kAbove) visible_[seen++] = f;
  if (seen == 0) return;
  // Edges that one visible face has and no other.
  uint32_t edges = 0;
  for (uint32_t i = 0; i < seen; ++i)
    for (int k = 0; k < 3; ++k) {
      const uint32_t from = face_[visible_[i]].corner[k], to = face_[visible_[i]].corner[(k + 1) % 3];
      bool inner = false;
      for (uint32_t e = 0; e < edges && !inner; ++e)
        if (horizon_[e * 2] == to && horizon_[e * 2 + 1] == from) {
          --edges;
          horizon_[e * 2] = horizon_[edges * 2], horizon_[e * 2 + 1] = horizon_[edges * 2 + 1];
          inner = true;
        }
      if (!inner) horizon_[edges * 2] = from, horizon_[edges * 2 + 1] = to, ++edges;
    }
  if (edges != seen + 2) return;  // rounding has cut the visible part in two: the point lies on the hull as nearly as can be told
  for (uint32_t i = seen; i-- > 0;) face_[visible_[i]] = face_[--faces_];  // from the last: visible_ rises
  for (uint32_t e = 0; e < edges; ++e) add(horizon_[e * 2], horizon_[e * 2 + 1], point);
}

}  // namespace lightwell::runtime
