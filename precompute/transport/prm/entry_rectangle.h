// The rectangle of surface that an entry point stands for.
#pragma once
#include <array>
#include <span>

#include "precompute/transport/prm/prm.h"

namespace lightwell::transport {

/// A triangle of a cluster's surface.
struct SurfacePiece {
  std::array<Vec3, 3> corner;
  Vec3 centroid, normal;
  float area;  // of it that counts: what is exposed
};

/// Gives the last of `entries`, which has its normal already, the rectangle of this area for the pieces about this centroid: their outline where that is a rectangle, else one with the axes and
/// the proportions of their second moments. (A square has no axes of its moments.)
void appendRectangle(std::span<const SurfacePiece> pieces, const Vec3& centroid, float area, PrmEntries& entries);

}  // namespace lightwell::transport
