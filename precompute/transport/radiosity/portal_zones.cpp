#include "precompute/transport/radiosity/portal_zones.h"

#include <algorithm>
#include <cmath>

#include "precompute/core/error.h"

namespace lightwell::transport {
namespace {

constexpr double kTolerance = 1e-3;  // of a leaf's extents: what touches its border
constexpr double kThinnest = 1e-5;   // internal units: what is nearer to a leaf without thickness touches it

}  // namespace

bool PortalZones::Leaf::isIn(const Vec3& p, double reach) const {
  const Vec3d offset = Vec3d(p) - origin;
  return std::abs(offset.dot(along)) <= width * (0.5 + kTolerance) + reach && std::abs(offset.dot(up)) <= height * (0.5 + kTolerance) + reach;
}

PortalZones::PortalZones(const scene::Scene& scene) : scene_(scene) {
  for (const scene::Portal& portal : scene.portals) {
    first_gate_.push_back(gates_);
    gates_ += portal.strips;
    if (gates_ > kMostGates)
      throw InputError(scene.file, portal.gltf_path, "the portals have more than " + std::to_string(kMostGates) + " strips together");
    // Across the way it opens a leaf is thin in one direction: the lesser principal axis of its surface.
    Leaf leaf;
    leaf.along = Vec3d(portal.axis).normalized();
    Vec3 t, b;
    orthonormalBasis(Vec3(leaf.along), t, b);
    const Vec3d e0(t), e1(b);
    double mass = 0, mean0 = 0, mean1 = 0, m00 = 0, m11 = 0, m01 = 0;
    for (uint32_t triangle = portal.first_triangle; triangle < portal.first_triangle + portal.triangle_count; ++triangle) {
      Vec3d corner[4];
      for (size_t c = 0; c < 3; ++c) corner[c] = Vec3d(scene.mesh.positions[scene.mesh.triangles[triangle][c]]);
      corner[3] = (corner[0] + corner[1] + corner[2]) / 3;
      const double area = (corner[1] - corner[0]).cross(corner[2] - corner[0]).length();
      for (size_t c = 0; c < 4; ++c) {
        const double weight = c < 3 ? area : 9 * area, x = corner[c].dot(e0), y = corner[c].dot(e1);
        mass += weight, mean0 += weight * x, mean1 += weight * y, m00 += weight * x * x, m11 += weight * y * y, m01 += weight * x * y;
      }
    }
    m00 -= mean0 * mean0 / mass, m11 -= mean1 * mean1 / mass, m01 -= mean0 * mean1 / mass;
    const double angle = std::atan2(2 * m01, m00 - m11) / 2;
    leaf.up = e0 * std::cos(angle) + e1 * std::sin(angle);
    leaf.through = leaf.along.cross(leaf.up);
    Imath::Box3d box;
    for (uint32_t triangle = portal.first_triangle; triangle < portal.first_triangle + portal.triangle_count; ++triangle)
      for (const uint32_t v : scene.mesh.triangles[triangle]) {
        const Vec3d p(scene.mesh.positions[v]);
        box.extendBy(Vec3d(p.dot(leaf.along), p.dot(leaf.up), p.dot(leaf.through)));
      }
    const Vec3d middle = box.center();
    leaf.origin = leaf.along * middle.x + leaf.up * middle.y + leaf.through * middle.z;
    leaf.width = box.size().x, leaf.height = box.size().y, leaf.thickness = box.size().z;
    leaf_.push_back(leaf);
  }
}

uint32_t PortalZones::gateOf(uint32_t triangle, const Vec3& point) const {
  for (size_t i = 0; i < leaf_.size(); ++i)
    if (scene_.portals[i].holds(triangle)) return first_gate_[i] + scene_.portals[i].strip(point);
  return kNone;
}

uint32_t PortalZones::portalOf(uint32_t gate) const {
  return uint32_t(std::upper_bound(first_gate_.begin(), first_gate_.end(), gate) - first_gate_.begin()) - 1;
}

bool PortalZones::isOnTwoSides(const Leaf& leaf, std::span<const Vec3> corners, const Vec3& middle) const {
  const double beyond = std::max(leaf.thickness * (0.5 - kTolerance), kThinnest);
  double low = leaf.across(middle), high = low;
  bool below = leaf.isIn(middle, 0);  // not beside the opening
  for (const Vec3& p : corners) {
    low = std::min(low, leaf.across(p)), high = std::max(high, leaf.across(p));
    below |= leaf.isIn(p, 0);
  }
  return below && low < -beyond && high > beyond;
}

PortalZone PortalZones::zoneOf(const atlas::Atlas& atlas, const atlas::Slot& slot, double reach) const {
  const auto pieces = std::span(atlas.patches).subspan(slot.first_patch, slot.patch_count);
  PortalZone zone;
  std::vector<Vec3> corners;
  for (uint16_t i = 0; i < leaf_.size(); ++i) {
    const Leaf& leaf = leaf_[i];
    const scene::Portal& portal = scene_.portals[i];
    const auto on_leaf = std::count_if(pieces.begin(), pieces.end(), [&](const atlas::Patch& piece) { return portal.holds(piece.triangle); });
    const bool near = std::abs(leaf.across(slot.position)) <= leaf.thickness / 2 + reach && leaf.isIn(slot.position, reach);
    if (!near && on_leaf == 0) continue;
    if (corners.empty())
      for (const atlas::Patch& piece : pieces)
        for (const Vec2& corner : piece.corner) corners.push_back(atlas::surfacePoint(scene_.mesh, piece.triangle, corner.x, corner.y).position);
    if (on_leaf > 0) {
      double low = 0, high = 0;
      for (const Vec3& p : corners) low = std::min(low, leaf.across(p)), high = std::max(high, leaf.across(p));
      const bool two_faces = low < -0.25 * leaf.thickness && high > 0.25 * leaf.thickness;
      if (two_faces || on_leaf < std::ptrdiff_t(pieces.size())) return {PortalZone::divided, i, 0};
      return {PortalZone::leaf, i, uint16_t(portal.strip(slot.position))};
    }
    if (zone.kind == PortalZone::beside && isOnTwoSides(leaf, corners, slot.position)) zone = {PortalZone::threshold, i, 0, std::move(zone.near)};
    zone.near.push_back(leaf.across(slot.position) < 0 ? -(i + 1) : i + 1);
  }
  return zone;
}

std::vector<PortalZone> PortalZones::ofSides(const atlas::Atlas& atlas, const Sides& sides, uint32_t square_texels) const {
  if (empty()) return {};
  float largest = 0;
  for (const atlas::Slot& slot : atlas.slots) largest = std::max(largest, slot.area);
  const double reach = 2.0 * square_texels * std::sqrt(double(largest));
  std::vector<PortalZone> zones;
  for (uint32_t side = 0; side < sides.slot.size(); ++side)
    zones.push_back(sides.isBack(side) ? zones[sides.slot[side]] : zoneOf(atlas, atlas.slots[sides.slot[side]], reach));
  return zones;
}

GateEntry PortalZones::entryAt(const PortalZone& zone, const Vec3& point) const {
  const auto gateIn = [&](size_t portal) { return first_gate_[portal] + scene_.portals[portal].strip(point); };
  if (zone.kind == PortalZone::leaf) return closedGate(gateIn(zone.portal));
  if (zone.kind == PortalZone::threshold) return openGate(gateIn(zone.portal));
  // What a leaf stands on is inside of it; and at the border of texels a point may be found in the one beyond it.
  for (const int32_t near : zone.near) {
    const auto portal = size_t(std::abs(near) - 1);
    const Leaf& leaf = leaf_[portal];
    const double outside = leaf.across(point) * (near < 0 ? -1 : 1);
    if (outside < leaf.thickness * (0.5 - kTolerance) && leaf.isIn(point, 0)) return openGate(gateIn(portal));
  }
  return kNoEntry;
}

bool mayMix(const PortalZone& a, const PortalZone& b) {
  if (a.hasGate() || b.hasGate()) return a.kind == b.kind && a.portal == b.portal;
  return std::none_of(a.near.begin(), a.near.end(), [&](int32_t near) { return std::find(b.near.begin(), b.near.end(), -near) != b.near.end(); });
}

}  // namespace lightwell::transport
