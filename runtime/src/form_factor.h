// Irradiance of Lambertian area lights at a point, unoccluded and exact, in float: form factors between a differential area and a polygon,
// disk or sphere. No dependencies; free of NaN for all finite arguments.
#pragma once
#include <algorithm>
#include <cmath>

namespace lightwell::runtime {

struct Float3 {
  float x, y, z;
};
inline Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Float3 operator*(Float3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
inline float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Float3 cross(Float3 a, Float3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
inline float largest(Float3 a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }

inline constexpr float kPiF = 3.14159265358979f;
inline constexpr unsigned kMostPolygonVertices = 8;
/// Polygons that are seen smaller than this (radius ÷ distance) are points: the error of that, its square, is then that of the sum over
/// edges, which cancel.
inline constexpr float kPointRadius = 0.004f;

/// One edge's part of Lambert's formula (Baum et al., "Improving Radiosity Solutions Through the Use of Analytically Determined
/// Form-Factors", 1989): the angle that it subtends times the cosine between its plane's normal and the receiver's. `a` and `b` with z
/// along the receiver's normal, about 1 in size.
inline float edgeIntegral(Float3 a, Float3 b) {
  const Float3 gamma = cross(a, b - a);  // a x b, with the difference taken before the products
  const float length = std::sqrt(dot(gamma, gamma)), cosine = dot(a, b);
  // On the edge itself its plane has no normal; from both sides together it counts nothing.
  if (!(length > 1e-12f)) return 0;
  return std::atan2(length, cosine) * (gamma.z / length);
}

/// The part of a hemisphere's cosine-weighted solid angle, 0 to 1, that a convex planar polygon covers: the irradiance by radiance 1,
/// divided by pi. `vertices`: counter-clockwise as seen from its front, which shines; 3 to kMostPolygonVertices; relative to the receiver,
/// whose unit normal is `normal`.
inline float polygonFormFactor(const Float3* vertices, unsigned count, Float3 normal) {
  // A frame about the normal (Duff et al. 2017), scaled so that no product leaves the range.
  float size = 0;
  for (unsigned i = 0; i < count; ++i) size = std::max(size, largest(vertices[i]));
  if (!(size > 0) || !(size < 1e38f)) return 0;
  const float sign = std::copysign(1.0f, normal.z), c = -1.0f / (sign + normal.z), d = normal.x * normal.y * c;
  const Float3 tangent{1 + sign * normal.x * normal.x * c, sign * d, -sign * normal.x},
      bitangent{d, sign + normal.y * normal.y * c, -normal.y};
  Float3 local[kMostPolygonVertices];
  for (unsigned i = 0; i < count; ++i) {
    const Float3 v = vertices[i] * (1 / size);
    local[i] = {dot(tangent, v), dot(bitangent, v), dot(normal, v)};
  }
  // Clipped by the receiver's horizon, edge by edge; what the horizon cuts off is closed along it.
  float sum = 0;
  Float3 last_cut{}, first_cut{};
  bool left = false, entered = false;
  for (unsigned i = 0; i < count; ++i) {
    const Float3 a = local[i], b = local[i + 1 < count ? i + 1 : 0];
    if (a.z > 0 && b.z > 0) {
      sum += edgeIntegral(a, b);
    } else if (a.z > 0 || b.z > 0) {
      const float t = a.z / (a.z - b.z);
      Float3 cut = a + (b - a) * t;
      cut.z = 0;
      if (a.z > 0) {
        sum += edgeIntegral(a, cut);
        last_cut = cut, left = true;
      } else {
        sum += edgeIntegral(cut, b);
        first_cut = cut, entered = true;
      }
    }
  }
  if (left && entered) sum += edgeIntegral(last_cut, first_cut);
  // Seen from the front, the vertices turn clockwise about the direction to it: the sum is negative.
  return std::clamp(-sum / (2 * kPiF), 0.0f, 1.0f);
}

/// Integral of the clamped cosine to `normal` over the directions within the angle of sine `sine` (0 to 1; at most a hemisphere) about a
/// direction whose cosine to the normal is `cosine`. Lagarde and de Rousiers, "Moving Frostbite to Physically Based Rendering" (2014),
/// listing 10, after Snyder 1996.
inline float coneIrradiance(float cosine, float sine) {
  cosine = std::clamp(cosine, -1.0f, 1.0f);
  const float sine2 = sine * sine;
  if (!(sine2 > 0)) return 0;
  if (cosine * cosine >= sine2) return kPiF * sine2 * std::max(cosine, 0.0f);
  const float normal_sine = std::sqrt(std::max(1 - cosine * cosine, 1e-12f)), x = std::sqrt(std::max(1 / sine2 - 1, 0.0f));
  const float y = std::clamp(-x * cosine / normal_sine, -1.0f, 1.0f), height = normal_sine * std::sqrt(1 - y * y);
  return std::max(0.0f, (cosine * std::acos(y) - x * height) * sine2 + std::atan2(height, x));
}

}  // namespace lightwell::runtime
