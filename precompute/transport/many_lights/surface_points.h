// Points spread evenly over the surfaces of a scene: what imperfect shadow maps are splatted from (Ritschel et al., "Imperfect Shadow Maps for Efficient
// Computation of Indirect Illumination", SIGGRAPH Asia 2008, section 3).
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/atlas/atlas.h"

namespace lightwell::transport {

struct SurfacePoint {
  Vec3 position;    // internal units
  Vec3 normal;      // unit, of the triangle's front
  uint32_t texel;   // of the atlas, that shows itself there; kNone: none
};

struct SurfacePoints {
  std::vector<SurfacePoint> points;
  double area = 0;  // internal units²: of all surface that lets no light through; each point stands for as much of it
};

/// `count` points, fewer only where nearly nothing is opaque, none in a scene without area. They are a scrambled (0, 2) sequence: one dimension runs over the area of all
/// triangles in the order of a space-filling curve, and along each triangle, the other across it. Every 2^k points that follow each other from a multiple of 2^k are spread
/// evenly, so a subset for each light is a block. Where surface is cut out or blended, points are kept with the probability alpha.
SurfacePoints spreadPoints(const scene::Scene& scene, const atlas::Atlas& atlas, uint32_t count, uint64_t seed);

}  // namespace lightwell::transport
