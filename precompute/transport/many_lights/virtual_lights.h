// Virtual lights: clusters of virtual points as points, disks, spheres or polygons. Luksch et al., "Fast Light-Map Computation with Virtual
// Polygon Lights" (I3D 2013), section 5.2.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "precompute/core/bytes.h"
#include "precompute/transport/many_lights/virtual_points.h"

namespace lightwell::transport {

enum class VirtualLightType : uint8_t { point = 1, disk, sphere, polygon };  // as in the container

struct VirtualLight {
  VirtualLightType type = VirtualLightType::point;
  uint32_t source = 0, bounce = 0;    // of VirtualPoint; the least bounce when rare later ones are in it too
  Vec3 position{0.0f}, normal{0.0f};  // internal units; the middle of its area
  Rgb power_rgb{0.0f};                // irradiance × internal units²
  float radius = 0;                   // of disks and spheres, internal units
  std::vector<Vec3> vertices;         // of polygons: 3 to 8, counter-clockwise from the front, convex, in one plane
};

struct ClusterOptions {
  uint32_t lights = 200;  // aimed at; at least one for each source and bounce that counts
  /// Empty: by expected error.
  std::optional<VirtualLightType> type;
  uint64_t seed = 1;
};

/// Ordered by source and bounce; their power is that of the points. `scene_radius` in internal units. Throws Cancelled; `cancel` may be
/// null.
std::vector<VirtualLight> clusterPoints(std::span<const VirtualPoint> points, float scene_radius, const ClusterOptions& options,
                                        const CancelFlag* cancel = nullptr);

/// As a task's result. readVirtualLights throws std::runtime_error for other bytes.
Bytes toBytes(std::span<const VirtualLight> lights);
std::vector<VirtualLight> readVirtualLights(ByteView bytes);

}  // namespace lightwell::transport
