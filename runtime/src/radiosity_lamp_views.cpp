// Views of lamps, and the solid angles of their pixels.
#include <algorithm>
#include <cmath>

#include "runtime/src/radiosity_injector.h"

namespace lightwell::runtime {
namespace {

constexpr float kWidestSpot_rad = 1.0f;   // half angle beyond which six faces show more than one
constexpr double kPi = 3.14159265358979323846;

/// Solid angle between the axis and the point (x, y) of the plane at 1: the corner term of a rectangle's.
double cornerAngle(double x, double y) { return std::atan2(x * y, std::sqrt(1 + x * x + y * y)); }

void orthonormal(const float* direction, View& view) {
  double norm = 0;
  for (int k = 0; k < 3; ++k) norm += double(direction[k]) * double(direction[k]);
  for (int k = 0; k < 3; ++k) view.forward[k] = double(direction[k]) / std::sqrt(norm);
  const int least = std::fabs(direction[0]) < std::fabs(direction[1]) ? (std::fabs(direction[0]) < std::fabs(direction[2]) ? 0 : 2)
                                                                      : (std::fabs(direction[1]) < std::fabs(direction[2]) ? 1 : 2);
  double axis[3] = {};
  axis[least] = 1;
  const double along = dot(axis, view.forward);
  for (int k = 0; k < 3; ++k) view.right[k] = axis[k] - along * view.forward[k];
  const double length = std::sqrt(dot(view.right, view.right));
  for (double& v : view.right) v /= length;
  for (int k = 0; k < 3; ++k)
    view.up[k] = view.forward[(k + 1) % 3] * view.right[(k + 2) % 3] - view.forward[(k + 2) % 3] * view.right[(k + 1) % 3];
}

void fitToBounds(const PackedLight& light, const float* bounds_min_m, const float* bounds_max_m, View& view) {
  view.perspective = false;
  orthonormal(light.direction, view);
  double half[2] = {};
  for (int k = 0; k < 3; ++k) {
    view.eye_m[k] = 0.5 * (double(bounds_min_m[k]) + double(bounds_max_m[k]));
    const double extent = double(bounds_max_m[k]) - view.eye_m[k];
    half[0] += extent * std::fabs(view.right[k]);
    half[1] += extent * std::fabs(view.up[k]);
  }
  for (int k = 0; k < 3; ++k) view.right[k] *= std::max(half[0], 1e-12), view.up[k] *= std::max(half[1], 1e-12);
}

double center(uint32_t i, uint32_t side) { return (2.0 * i + 1) / side - 1; }
double border(uint32_t i, uint32_t side) { return 2.0 * i / side - 1; }

}  // namespace

LampViews lampViews(const PackedLight& light, const float* bounds_min_m, const float* bounds_max_m) {
  LampViews views;
  View& view = views.view[0];
  for (int k = 0; k < 3; ++k) view.eye_m[k] = double(light.position_m[k]);
  views.count = 1;
  if (isType(light, LW_LIGHT_DIRECTIONAL)) {
    fitToBounds(light, bounds_min_m, bounds_max_m, view);
    return views;
  }
  const bool spot = isType(light, LW_LIGHT_SPOT);
  const double outer = spot ? std::acos(std::clamp(-double(light.spot_offset) / double(light.spot_scale), 0.0, 1.0)) : kPi;
  if (spot && outer <= double(kWidestSpot_rad)) {
    orthonormal(light.direction, view);
    views.tangent = std::tan(outer);
    for (int k = 0; k < 3; ++k) view.right[k] *= views.tangent, view.up[k] *= views.tangent;
    return views;
  }
  // A cube that is aligned with nothing: along the edges of patches, pixels then change sides one after the other when the lamp moves, not whole rows at once.
  constexpr float kAskew[3] = {0.51f, 0.62f, 0.5963f};
  View askew = view;
  orthonormal(kAskew, askew);
  const double* axis[3] = {askew.forward, askew.right, askew.up};
  views.count = 6;
  for (int f = 0; f < 6; ++f) {
    views.view[f] = askew;
    for (int k = 0; k < 3; ++k) {
      views.view[f].forward[k] = axis[f / 2][k] * (f % 2 ? -1 : 1);
      views.view[f].right[k] = axis[(f / 2 + 1) % 3][k];
      views.view[f].up[k] = axis[(f / 2 + 2) % 3][k];
    }
  }
  return views;
}

double lampEdge(const PackedLight& light, const View& view, double x, double y) {
  if (!isType(light, LW_LIGHT_SPOT)) return 1;
  double way[3], along = 0;
  for (int k = 0; k < 3; ++k) way[k] = view.forward[k] + x * view.right[k] + y * view.up[k];
  for (int k = 0; k < 3; ++k) along += way[k] * double(light.direction[k]);
  const double edge = std::clamp(along / std::sqrt(dot(way, way)) * double(light.spot_scale) + double(light.spot_offset), 0.0, 1.0);
  return edge * edge;
}

double spotAngle(const PackedLight& light) {
  const double scale = double(light.spot_scale), outer = -double(light.spot_offset) / scale, edge = 1 / scale;
  if (outer + edge <= 1) return 2 * kPi * ((1 - outer - edge) + edge / 3);
  return 2 * kPi * std::pow(1 - outer, 3) * scale * scale / 3;
}

double spotScale(const PackedLight& light, const LampViews& views, uint32_t side, double* corner) {
  if (!isType(light, LW_LIGHT_SPOT)) return 1;
  double found = 0;
  for (int v = 0; v < views.count; ++v)
    for (uint32_t j = 0; j < side; ++j) {
      bool angles_known = false;
      for (uint32_t i = 0; i < side; ++i) {
        const double edge = lampEdge(light, views.view[v], center(i, side), center(j, side));
        if (!(edge > 0)) continue;
        if (!angles_known) cornerAngles(views.tangent, side, j, corner);
        angles_known = true;
        found += edge * pixelAngle(corner, side, i);
      }
    }
  return found > 0 ? spotAngle(light) / found : 0;
}

void cornerAngles(double tangent, uint32_t side, uint32_t j, double* corner) {
  const uint32_t corners = side + 1;
  for (uint32_t k = 0; k < corners * 2; ++k) corner[k] = cornerAngle(tangent * border(k % corners, side), tangent * border(j + k / corners, side));
}

}  // namespace lightwell::runtime
