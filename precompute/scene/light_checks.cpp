#include "precompute/scene/light_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace lightwell::scene {
namespace {
constexpr double kImplausible = 1e7;  // candela or lux; the sun gives 1e5 lux, a searchlight some 1e6 candela
constexpr double kLargest = 1e16;     // stays inside a float in the internal units of the smallest scene
constexpr double kHalfPi = std::numbers::pi / 2;
constexpr double kNarrowestEdge = 1e-3;  // radians between the inner and the outer cone
}  // namespace

void setIntensity(Light& light, const Vec3d& color, double intensity, const std::string& place, Diagnostics& diagnostics) {
  const char* unit = light.type == LightType::directional ? "lx" : "cd";
  if (intensity < 0) {
    diagnostics.warn(place, "the intensity of the light is negative; taken as zero");
    intensity = 0;
  }
  if (std::min({color.x, color.y, color.z}) < 0) diagnostics.warn(place, "the colour of the light is negative; taken as zero there");
  if (intensity > kImplausible) {
    char text[64];
    std::snprintf(text, sizeof text, "the light has %.4g %s", intensity, unit);
    diagnostics.warn(place, std::string(text) + ", which is implausible; are the light units right?");
  }
  for (int c = 0; c < 3; ++c) {
    const double value = std::max(color[c], 0.0) * intensity;
    if (value > kLargest) diagnostics.warn(place, "the intensity of the light is absurd; limited");
    light.intensity[c] = float(std::min(value, kLargest));
  }
}

void setCone(Light& light, double inner_cone_angle, double outer_cone_angle, const std::string& place, Diagnostics& diagnostics) {
  double outer = outer_cone_angle > 0 ? std::min(outer_cone_angle, kHalfPi) : std::numbers::pi / 4;
  double inner = std::clamp(inner_cone_angle, 0.0, outer);
  if (outer > outer_cone_angle + 1e-6 || outer < outer_cone_angle - 1e-6 || inner != inner_cone_angle || inner >= outer)
    diagnostics.warn(place, "the cone of the spot light is not 0 ≤ inner < outer ≤ π/2; repaired");
  if (inner >= outer) inner = std::max(0.0, outer - kNarrowestEdge);
  light.inner_cone_angle = float(inner);
  light.outer_cone_angle = float(outer);
}

}  // namespace lightwell::scene
