// A frame about a direction.
#pragma once
#include <cmath>

namespace lightwell::runtime {

/// Unit vectors perpendicular to the unit vector `n` and to each other, [3] each; the GLSL lwBasis and the sections' tangents T and B are the same
/// (Duff et al.: "Building an Orthonormal Basis, Revisited", listing 3).
inline void frameAbout(const float* n, float* tangent, float* bitangent) {
  const float sign = std::copysign(1.0f, n[2]), a = -1.0f / (sign + n[2]), b = n[0] * n[1] * a;
  tangent[0] = 1.0f + sign * n[0] * n[0] * a, tangent[1] = sign * b, tangent[2] = -sign * n[0];
  bitangent[0] = b, bitangent[1] = sign + n[1] * n[1] * a, bitangent[2] = -n[1];
}

}  // namespace lightwell::runtime
