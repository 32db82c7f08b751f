// What light of lamps on patches needs to know on the CPU and on OpenGL: the lamps' views, and whose light a visible point is.
#pragma once
#include "runtime/src/light.h"
#include "runtime/src/radiosity.h"
#include "runtime/src/radiosity_view.h"

struct lw_radiosity_injector {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  const lw_radiosity* radiosity = nullptr;
  lightwell::runtime::Surfaces surfaces;
  Array<float> lightmap_uv;            // [vertices][2]
  Array<uint8_t> flags;                // [triangles]
  Array<uint32_t> value_of_texel;      // [height * width]: index into the radiosity's texels, or kNone
  Array<uint32_t> nearest_patch;       // [triangles][2]: for light that falls on no texel's patch, front and back; kUnknownPatch until it is needed
  Array<double> power_rgb;             // [patches][3]
  Array<double> corner;                // [2][side + 1]: solid angles to the corners of a row of pixels
  float bounds_min_m[3], bounds_max_m[3];
  lightwell::runtime::ViewRaster raster;
};

namespace lightwell::runtime {

/// The views that together hold all that a lamp shines on.
struct LampViews {
  View view[6];
  int count = 0;
  double tangent = 1;  // of the half angle of perspective views, which `right` and `up` contain already
};
/// Six faces of a cube for a point light, one view for a spot up to 1 rad from its axis (else six), an orthographic one of the bounds for a directional light.
LampViews lampViews(const PackedLight& light, const float* bounds_min_m, const float* bounds_max_m);

/// The share of a spot's light that goes the way (x, y) of a view; 1 for a point light.
double lampEdge(const PackedLight& light, const View& view, double x, double y);
/// The integral of a spot's edge over its cone: what its intensity times this is, is its power.
double spotAngle(const PackedLight& light);
/// What the edges at the centres of side² pixels must be multiplied with so that the spot's power is exact; 0 when no pixel has light, 1 for other lights.
double spotScale(const PackedLight& light, const LampViews& views, uint32_t side, double* corner);
/// Solid angles to the corners of row j of side² pixels: corner[2][side + 1].
void cornerAngles(double tangent, uint32_t side, uint32_t j, double* corner);
inline double pixelAngle(const double* corner, uint32_t side, uint32_t i) {
  return (corner[side + 1 + i + 1] - corner[side + 1 + i]) - (corner[i + 1] - corner[i]);
}

inline constexpr uint32_t kUnknownPatch = 0xfffffffeu;
/// Texels around one without a patch in which another is looked for.
inline constexpr uint32_t kPatchNeighbourhood = 2;

/// Whose light it is that a visible point receives.
class PatchFinder {
 public:
  explicit PatchFinder(lw_radiosity_injector& injector) : i_(injector), r_(*injector.radiosity) {}

  /// A texel's own patch, or kNone.
  uint32_t patchOf(uint32_t texel, bool front) const;
  /// Of length twice the triangle's area, on its front or its back.
  void normalOf(uint32_t triangle, bool front, double* normal) const;
  /// The patch at light-map coordinates on a triangle's side, which `normal` points to: the texel's, a near texel's, or the nearest one. kNone: absorbed.
  uint32_t patchAt(uint32_t triangle, bool front, const double* normal, const double* uv);
  /// Brings nearest_patch up to date wherever patchAt could ask for it; kNone elsewhere.
  void findNearest();

 private:
  bool faces(uint32_t patch, const double* normal) const;
  uint32_t patchNear(uint32_t x, uint32_t y, bool front, const double* normal) const;
  uint32_t nearestTo(uint32_t triangle, bool front, const double* normal);
  bool needsNearest(uint32_t triangle, bool front, const double* normal) const;

  lw_radiosity_injector& i_;
  const lw_radiosity& r_;
};

}  // namespace lightwell::runtime
