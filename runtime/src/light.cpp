#include "runtime/src/light.h"

#include <algorithm>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/frame.h"

namespace lightwell::runtime {

const char* packLight(const lw_light& light, PackedLight& packed) {
  packed = {};
  if (light.type != LW_LIGHT_POINT && light.type != LW_LIGHT_SPOT && light.type != LW_LIGHT_DIRECTIONAL) return "its type is unknown";
  packed.type = float(light.type);
  for (const float v : light.intensity_rgb)
    if (!(v >= 0) || !std::isfinite(v)) return "its intensity is negative or not finite";
  std::memcpy(packed.intensity_rgb, light.intensity_rgb, sizeof packed.intensity_rgb);
  if (light.type != LW_LIGHT_DIRECTIONAL) {
    if (!allFinite(light.position_m, 3)) return "its position is not finite";
    if (!(light.range_m >= 0) || !std::isfinite(light.range_m)) return "its range is negative or not finite";
    std::memcpy(packed.position_m, light.position_m, sizeof packed.position_m);
    packed.range_m = light.range_m;
  }
  if (light.type != LW_LIGHT_POINT) {
    double length = 0;
    for (const float v : light.direction) length += double(v) * v;
    length = std::sqrt(length);
    if (!(length > 0) || !std::isfinite(length)) return "its direction is zero or not finite";
    for (int k = 0; k < 3; ++k) packed.direction[k] = float(light.direction[k] / length);
  }
  if (light.type == LW_LIGHT_SPOT) {
    const float inner = light.inner_cone_angle_rad, outer = light.outer_cone_angle_rad;
    if (!(inner >= 0 && inner < outer && outer <= 1.5707964f)) return "its cone angles are not 0 <= inner < outer <= pi/2";
    // KHR_lights_punctual, "Inner and Outer Cone Angles": the smooth edge as a scale and an offset of the cosine.
    packed.spot_scale = 1.0f / std::max(0.001f, std::cos(inner) - std::cos(outer));
    packed.spot_offset = -std::cos(outer) * packed.spot_scale;
  }
  return nullptr;
}

namespace {

/// Beyond so many times the longer half side, the middle of a rectangle stands for all of it within two parts in a thousand.
constexpr float kFar = 35.0f;

float dot(const float* a, const float* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Solid angle of the triangle of three directions of any length (Van Oosterom, Strackee: "The Solid Angle of a Plane Triangle", equation 8).
float solidAngle(const float* a, const float* b, const float* c) {
  const float la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
  const float triple = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  return 2.0f * std::atan2(std::fabs(triple), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

float rectangleGain(const float* to_light_m, const float* normal, const float* rectangle) {
  const float area = 4.0f * rectangle[0] * rectangle[1], reach = kFar * std::max(rectangle[0], rectangle[1]);
  const float square = dot(to_light_m, to_light_m), height = dot(to_light_m, normal);
  if (!(area > 0) || !(square < reach * reach) || !(height > 0)) return 1.0f;
  float tangent[3], bitangent[3];
  frameAbout(normal, tangent, bitangent);
  const float c = std::cos(rectangle[2] * 3.14159265f), s = std::sin(rectangle[2] * 3.14159265f);
  float corner[4][3];
  for (int i = 0; i < 4; ++i) {
    const float along_u = (i == 1 || i == 2) ? rectangle[0] : -rectangle[0], along_v = i >= 2 ? rectangle[1] : -rectangle[1];
    for (int k = 0; k < 3; ++k)
      corner[i][k] = (tangent[k] * c + bitangent[k] * s) * along_u + (bitangent[k] * c - tangent[k] * s) * along_v - to_light_m[k];
  }
  const float angle = solidAngle(corner[0], corner[1], corner[2]) + solidAngle(corner[0], corner[2], corner[3]);
  return angle * square * std::sqrt(square) / (area * height);
}

bool lightIrradiance(const PackedLight& light, const float* position_m, const float* normal, float* irradiance_rgb, float* to_light,
                     float& distance_m) {
  float attenuation = 1.0f;
  if (isType(light, LW_LIGHT_DIRECTIONAL)) {
    for (int k = 0; k < 3; ++k) to_light[k] = -light.direction[k];
    distance_m = INFINITY;
  } else {
    float square = 0.0f;
    for (int k = 0; k < 3; ++k) {
      to_light[k] = light.position_m[k] - position_m[k];
      square += to_light[k] * to_light[k];
    }
    if (!(square > 1e-36f) || !std::isfinite(square)) return false;
    distance_m = std::sqrt(square);
    for (int k = 0; k < 3; ++k) to_light[k] /= distance_m;
    attenuation = 1.0f / square;
    if (light.range_m > 0) {
      float fourth = square / (light.range_m * light.range_m);
      fourth *= fourth;
      attenuation *= std::clamp(1.0f - fourth, 0.0f, 1.0f);
    }
  }
  if (isType(light, LW_LIGHT_SPOT)) {
    const float cosine = -(to_light[0] * light.direction[0] + to_light[1] * light.direction[1] + to_light[2] * light.direction[2]);
    const float edge = std::clamp(cosine * light.spot_scale + light.spot_offset, 0.0f, 1.0f);
    attenuation *= edge * edge;
  }
  attenuation *= std::max(to_light[0] * normal[0] + to_light[1] * normal[1] + to_light[2] * normal[2], 0.0f);
  bool any = false;
  for (int k = 0; k < 3; ++k) {
    irradiance_rgb[k] = std::min(light.intensity_rgb[k] * attenuation, kMaxIrradiance);
    any |= irradiance_rgb[k] > 0;
  }
  return any;
}

}  // namespace lightwell::runtime
