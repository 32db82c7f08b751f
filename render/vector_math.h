// The vectors and matrices a viewer needs. Column-major, right-handed, clip space as OpenGL has it.
#pragma once
#include <array>
#include <cmath>

namespace lightwell::render {

/// A type of its own, so that its operators are found from any namespace.
struct Float3 : std::array<float, 3> {};
using Matrix4 = std::array<float, 16>;

inline Float3 operator+(const Float3& a, const Float3& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
inline Float3 operator-(const Float3& a, const Float3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Float3 operator*(const Float3& a, float s) { return {a[0] * s, a[1] * s, a[2] * s}; }
inline float dot(const Float3& a, const Float3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline Float3 cross(const Float3& a, const Float3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
inline float length(const Float3& a) { return std::sqrt(dot(a, a)); }
/// Unit vector; `a` must not be zero.
inline Float3 normalized(const Float3& a) { return a * (1.0f / length(a)); }
/// A unit vector perpendicular to the unit vector `a`.
inline Float3 perpendicular(const Float3& a) {
  return normalized(cross(a, std::abs(a[1]) < 0.9f ? Float3{0, 1, 0} : Float3{1, 0, 0}));
}

inline Matrix4 operator*(const Matrix4& a, const Matrix4& b) {
  Matrix4 product{};
  for (size_t column = 0; column < 4; ++column)
    for (size_t row = 0; row < 4; ++row)
      for (size_t k = 0; k < 4; ++k) product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return product;
}

/// World to eye: the eye looks along `forward` (unit), with `up` (not parallel to it) upward in the picture.
inline Matrix4 lookAlong(const Float3& eye, const Float3& forward, const Float3& up) {
  const Float3 right = normalized(cross(forward, up)), top = cross(right, forward);
  return {right[0], top[0], -forward[0], 0, right[1], top[1], -forward[1], 0, right[2], top[2], -forward[2], 0,
          -dot(right, eye), -dot(top, eye), dot(forward, eye), 1};
}

/// `slope_x`, `slope_y`: tangents of the half angles of view.
inline Matrix4 perspective(float slope_x, float slope_y, float near, float far) {
  return {1 / slope_x, 0, 0, 0, 0, 1 / slope_y, 0, 0, 0, 0, -(far + near) / (far - near), -1, 0, 0, -2 * far * near / (far - near), 0};
}

inline Matrix4 orthographic(float half_width, float half_height, float near, float far) {
  return {1 / half_width, 0, 0, 0, 0, 1 / half_height, 0, 0, 0, 0, -2 / (far - near), 0, 0, 0, -(far + near) / (far - near), 1};
}

}  // namespace lightwell::render
