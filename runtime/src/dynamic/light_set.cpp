#include "runtime/src/dynamic/light_set.h"

#include <algorithm>
#include <cmath>

namespace lightwell::runtime {
namespace {

constexpr double kPi = 3.14159265358979323846;
/// A valid light moves only if it is left with so much more room.
constexpr double kWorthMoving = 1.5;
constexpr uint32_t kGhosts = 1;  // points of the hull that are no lights: behind a cone, a plane's infinity

double distance(Double3 a, Double3 b) { return std::sqrt(dot(a - b, a - b)); }

/// Point i of n that are spread evenly (Fibonacci lattice; in a plane the R2 sequence).
Double3 spread(const LampProjection& p, uint32_t i, uint32_t n) {
  constexpr double kGolden = 0.6180339887498949;
  if (p.kind == LampProjection::plane) {
    const double u = 0.5 + i * 0.7548776662466927, v = 0.5 + i * 0.5698402909980532;
    return {2 * (u - std::floor(u)) - 1, 2 * (v - std::floor(v)) - 1, 0};
  }
  const double low = p.kind == LampProjection::cone ? double(p.cos_outer) : -1.0;
  const double z = 1 - (i + 0.5) / n * (1 - low), r = std::sqrt(std::max(1 - z * z, 0.0)), angle = 2 * kPi * i * kGolden;
  const Double3 axis{double(p.axis[0]), double(p.axis[1]), double(p.axis[2])};
  const Double3 side = std::fabs(axis.x) > 0.5 ? Double3{axis.y, -axis.x, 0} : Double3{0, axis.z, -axis.y};
  const Double3 s = side * (1 / std::sqrt(dot(side, side))), t = cross(axis, s);
  const double a = r * std::cos(angle), b = r * std::sin(angle);
  return {s.x * a + t.x * b + axis.x * z, s.y * a + t.y * b + axis.y * z, s.z * a + t.z * b + axis.z * z};
}

}  // namespace

bool LightSet::allocate(const Host& host, uint32_t lights) {
  lights_ = lights;
  return aim_.allocate(host, lights) && hull_point_.allocate(host, lights + kGhosts) && slot_.allocate(host, lights) && nearest_.allocate(host, lights) &&
         nearest_distance_.allocate(host, lights) && gaps_.allocate(host, size_t(lights) * 2 + 8) && hull_.allocate(host, lights + kGhosts);
}

uint32_t LightSet::restart(const LampProjection& projection, LightRequest* requests) const {
  for (uint32_t i = 0; i < lights_; ++i) {
    const Double3 aim = spread(projection, i, lights_);
    requests[i] = {{float(aim.x), float(aim.y), float(aim.z)}, float(i)};
  }
  return lights_;
}

/// In a plane: metres over the greater half extent, onto the lower half of the sphere.
Double3 LightSet::lifted(Double3 aim) const {
  if (projection_->kind != LampProjection::plane) return aim;
  const double square = aim.x * aim.x + aim.y * aim.y;
  return {2 * aim.x / (square + 1), 2 * aim.y / (square + 1), (square - 1) / (square + 1)};
}

bool LightSet::isInside(Double3 aim) const {
  const LampProjection& p = *projection_;
  const double most = double(std::max(p.half[0], p.half[1]));
  if (p.kind == LampProjection::plane) return std::fabs(aim.x) * most <= double(p.half[0]) && std::fabs(aim.y) * most <= double(p.half[1]);
  return p.kind == LampProjection::sphere || aim.x * double(p.axis[0]) + aim.y * double(p.axis[1]) + aim.z * double(p.axis[2]) >= double(p.cos_outer);
}

double LightSet::room(Double3 at) const {
  double least = 1e30;
  for (uint32_t i = 0; i < placed_; ++i) least = std::min(least, distance(at, aim_[i]));
  return least;
}

/// Places at the border that are as far from a as from b. Returns how many.
int LightSet::borderPlaces(Double3 a, Double3 b, Double3* places) const {
  const LampProjection& p = *projection_;
  const Double3 d = b - a;
  int count = 0;
  if (p.kind == LampProjection::plane) {
    const double most = double(std::max(p.half[0], p.half[1])), x = double(p.half[0]) / most, y = double(p.half[1]) / most;
    const double along = 0.5 * (dot(b, b) - dot(a, a));
    for (const double side : {-1.0, 1.0}) {
      const double at_y = (along - side * x * d.x) / d.y, at_x = (along - side * y * d.y) / d.x;
      if (std::fabs(at_y) <= y) places[count++] = {side * x, at_y, 0};
      if (std::fabs(at_x) <= x) places[count++] = {at_x, side * y, 0};
    }
    return count;
  }
  const Double3 axis{double(p.axis[0]), double(p.axis[1]), double(p.axis[2])}, line = cross(axis, d);
  const double turned = dot(axis, d), scale = double(p.cos_outer) / (1 - turned * turned / dot(d, d)), back = -scale * turned / dot(d, d);
  const Double3 foot{axis.x * scale + d.x * back, axis.y * scale + d.y * back, axis.z * scale + d.z * back};
  const double reach = std::sqrt((1 - dot(foot, foot)) / dot(line, line));
  if (!(reach >= 0)) return 0;
  for (const double side : {-reach, reach}) places[count++] = {foot.x + line.x * side, foot.y + line.y * side, foot.z + line.z * side};
  return count;
}

/// The circle through the corners of a face. Where its middle is outside, the widest of those about the places where the bisectors of its edges leave the projection. Radius −1: not wider than `least`.
LightSet::Gap LightSet::gapOf(const SphereHull::Face& face, double least) const {
  Double3 middle = face.normal;
  const bool plane = projection_->kind == LampProjection::plane, sphere = projection_->kind == LampProjection::sphere;
  bool exact = sphere;
  if (!sphere) {
    exact = true;
    for (const uint32_t corner : face.corner) exact &= corner >= kGhosts;
    if (plane) {
      // Lifted points (2x, 2y, r² − 1) / (r² + 1) with normal · point = offset are those of a circle about −normal.xy / (normal.z − offset).
      const double w = face.normal.z - face.offset;
      exact &= std::fabs(w) > 1e-12;
      middle = {-face.normal.x / w, -face.normal.y / w, 0};
    }
  }
  Gap widest{{0, 0, 0}, -1};
  if (exact && isInside(middle)) {
    const double radius = plane ? distance(middle, aim_[face.corner[0] - kGhosts]) : std::sqrt(std::max(2 - 2 * face.offset, 0.0));
    return radius > least ? Gap{middle, radius} : widest;
  }
  for (int k = 0; k < 3; ++k) {
    const uint32_t a = face.corner[k], b = face.corner[(k + 1) % 3];
    if (a < kGhosts || b < kGhosts) continue;
    Double3 places[4];
    const int count = borderPlaces(aim_[a - kGhosts], aim_[b - kGhosts], places);
    for (int i = 0; i < count; ++i)
      if (const double radius = distance(places[i], aim_[a - kGhosts]); radius > std::max(least, widest.radius) && room(places[i]) > radius * (1 - 1e-6)) widest = {places[i], radius};
  }
  return widest;
}

LightSet::Gap LightSet::widestGap() const {
  Gap widest{{0, 0, 0}, -1};
  for (uint32_t f = 0; f < hull_.count(); ++f)
    if (const Gap gap = gapOf(hull_.face(f), widest.radius); gap.radius > widest.radius) widest = gap;
  if (projection_->kind == LampProjection::plane) {
    const double most = double(std::max(projection_->half[0], projection_->half[1]));
    for (int i = 0; i < 4; ++i) {
      const Double3 corner{(i & 1 ? 1 : -1) * double(projection_->half[0]) / most, (i & 2 ? 1 : -1) * double(projection_->half[1]) / most, 0};
      if (const double radius = room(corner); placed_ && radius > widest.radius) widest = {corner, radius};
    }
  }
  if (widest.radius > 0) return widest;
  // Too few lights for a triangulation.
  for (uint32_t i = 0; i < lights_; ++i) {
    Double3 candidate = spread(*projection_, i, lights_);
    if (projection_->kind == LampProjection::plane) {
      const double most = double(std::max(projection_->half[0], projection_->half[1]));
      candidate.x *= double(projection_->half[0]) / most, candidate.y *= double(projection_->half[1]) / most;
    }
    if (const double radius = room(candidate); radius > widest.radius) widest = {candidate, radius};
  }
  return widest;
}

void LightSet::place(Double3 aim) {
  aim_[placed_++] = aim;
  hull_.insert(lifted(aim));
}

void LightSet::findNearest(uint32_t i) {
  nearest_distance_[i] = 1e30;
  nearest_[i] = i;
  for (uint32_t k = 0; k < placed_; ++k)
    if (const double d = k == i ? 1e30 : distance(aim_[i], aim_[k]); d < nearest_distance_[i]) nearest_distance_[i] = d, nearest_[i] = k;
}

/// The shortest edge of a Delaunay triangulation joins the closest pair.
void LightSet::removeCrowded(uint32_t most) {
  const uint32_t gaps = hull_.count();
  for (uint32_t f = 0; f < gaps; ++f) gaps_[f] = gapOf(hull_.face(f), 0).radius;
  const uint32_t wanted = std::min(most, gaps);
  std::partial_sort(gaps_.begin(), gaps_.begin() + wanted, gaps_.begin() + gaps, [](double a, double b) { return a > b; });
  for (uint32_t i = 0; i < placed_; ++i) findNearest(i);
  for (uint32_t r = 0; r < wanted && placed_ > 4; ++r) {
    const uint32_t a = uint32_t(std::min_element(nearest_distance_.begin(), nearest_distance_.begin() + placed_) - nearest_distance_.begin()), b = nearest_[a];
    // The faces around a gap share it: its neighbours are not as wide once it is filled.
    if (!(gaps_[r] > kWorthMoving * nearest_distance_[a])) return;
    double room_a = 1e30, room_b = 1e30;
    for (uint32_t k = 0; k < placed_; ++k)
      if (k != a && k != b) room_a = std::min(room_a, distance(aim_[a], aim_[k])), room_b = std::min(room_b, distance(aim_[b], aim_[k]));
    const uint32_t gone = room_a < room_b ? a : b, last = --placed_;
    aim_[gone] = aim_[last], slot_[gone] = slot_[last], nearest_[gone] = nearest_[last], nearest_distance_[gone] = nearest_distance_[last];
    for (uint32_t i = 0; i < placed_; ++i)
      if (nearest_[i] == gone || i == gone) findNearest(i);
      else if (nearest_[i] == last) nearest_[i] = gone;
  }
}

uint32_t LightSet::update(const LampProjection& projection, const float* aims, uint32_t most_updates, LightRequest* requests, uint32_t& shining) {
  projection_ = &projection;
  const double most = double(std::max(projection.half[0], projection.half[1]));
  const double scale_x = projection.kind == LampProjection::plane ? double(projection.half[0]) / most : 1;
  const double scale_y = projection.kind == LampProjection::plane ? double(projection.half[1]) / most : 1;
  placed_ = 0;
  for (uint32_t i = 0; i < lights_; ++i) {
    const float* a = aims + size_t(i) * 4;
    if (!(a[3] > 0.5f) || !allFinite(a, 3)) continue;
    slot_[placed_] = i;
    Double3 aim{double(a[0]) * scale_x, double(a[1]) * scale_y, double(a[2])};
    if (projection.kind != LampProjection::plane) aim = aim * (1 / std::sqrt(std::max(dot(aim, aim), 1e-30)));
    aim_[placed_++] = aim;
  }
  const auto buildHull = [&] {
    const bool plane = projection.kind == LampProjection::plane;
    // A sphere has no need of a ghost: its first light stands in for it.
    hull_point_[0] = plane ? Double3{0, 0, 1} : projection.kind == LampProjection::cone ? Double3{-double(projection.axis[0]), -double(projection.axis[1]), -double(projection.axis[2])}
                           : placed_ ? aim_[0] : Double3{0, 0, 1};
    for (uint32_t i = 0; i < placed_; ++i) hull_point_[i + kGhosts] = lifted(aim_[i]);
    hull_.build(hull_point_.data(), placed_ + kGhosts);
  };
  buildHull();
  const uint32_t free_before = lights_ - placed_;
  if (free_before < most_updates) {
    removeCrowded(most_updates - free_before);
    if (lights_ - placed_ != free_before) buildHull();
  }
  // Slots that no light has.
  const uint32_t count = std::min(lights_ - placed_, most_updates), kept = placed_;
  for (uint32_t r = 0; r < count; ++r) {
    const Gap gap = widestGap();
    place(gap.middle);
    requests[r] = {{float(gap.middle.x / scale_x), float(gap.middle.y / scale_y), float(gap.middle.z)}, 0};
  }
  uint32_t next = 0;
  std::sort(slot_.begin(), slot_.begin() + kept);
  for (uint32_t slot = 0, k = 0; slot < lights_ && next < count; ++slot) {
    if (k < kept && slot_[k] == slot) ++k;
    else requests[next++].light = float(slot);
  }
  shining = placed_;
  projection_ = nullptr;
  return count;
}

}  // namespace lightwell::runtime
