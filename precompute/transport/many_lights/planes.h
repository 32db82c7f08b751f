// Planes among virtual points: RANSAC after Schnabel et al., "Efficient RANSAC for Point-Cloud Shape Detection" (CGF 2007). Points have
// normals, so that one of them is a hypothesis.
#pragma once
#include <span>
#include <vector>

#include "precompute/transport/many_lights/virtual_points.h"

namespace lightwell::transport {

struct PlaneOptions {
  float distance = 0;            // a point this far from a plane still lies on it, internal units
  float least_cosine = 0.9995f;  // between its normal and the plane's
  uint32_t least_points = 8;     // on a plane
  uint64_t seed = 1;
};

/// A connected part of a plane. Indices ascend.
struct PlanarPoints {
  Vec3 normal;
  std::vector<uint32_t> points;
};
struct DetectedPlanes {
  std::vector<PlanarPoints> planes;
  std::vector<uint32_t> rest;
};

/// Splits the points `members` of `points`. The result depends on nothing but the arguments. Throws Cancelled; `cancel` may be null.
DetectedPlanes detectPlanes(std::span<const VirtualPoint> points, std::span<const uint32_t> members, const PlaneOptions& options,
                            const CancelFlag* cancel);

}  // namespace lightwell::transport
