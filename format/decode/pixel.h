// Small numeric encodings of the container: RGB9E5, half floats, octahedral normals, sRGB bytes. Exact and the same on every machine
// (sRGB encoding up to the last bit of the C library's pow). Decoding is constexpr where the language allows it.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

namespace lightwell::format {

struct Float3 {
  float x = 0, y = 0, z = 0;
};

namespace detail {
/// 2^exponent for exponents of normal floats, −126 to 127.
constexpr float powerOfTwo(int exponent) { return std::bit_cast<float>(uint32_t(exponent + 127) << 23); }
/// floor(log2(v)) of a normal positive float.
constexpr int floorLog2(float v) { return int(std::bit_cast<uint32_t>(v) >> 23) - 127; }
}  // namespace detail

// ---- RGB9E5: three 9-bit mantissas (R in bits 0–8, G 9–17, B 18–26) and a shared exponent (27–31); EXT_texture_shared_exponent.

inline constexpr float kRgb9e5Max = 65408.0f;  // 511/512 * 2^16

/// Value = mantissa * 2^(exponent − 24), exact.
constexpr Float3 unpackRgb9e5(uint32_t v) {
  const float scale = detail::powerOfTwo(int(v >> 27) - 24);
  return {float(v & 0x1ff) * scale, float((v >> 9) & 0x1ff) * scale, float((v >> 18) & 0x1ff) * scale};
}

/// Nearest by the extension's rule: the exponent is that of the largest component, mantissas are rounded half up. Negative and NaN
/// become 0, more than kRgb9e5Max becomes kRgb9e5Max.
constexpr uint32_t packRgb9e5(Float3 c) {
  const auto clamp = [](float v) { return v > 0.0f ? (v < kRgb9e5Max ? v : kRgb9e5Max) : 0.0f; };
  const float r = clamp(c.x), g = clamp(c.y), b = clamp(c.z);
  const float largest = std::max(r, std::max(g, b));
  int exponent = largest >= detail::powerOfTwo(-16) ? detail::floorLog2(largest) + 16 : 0;  // biased by 15, for mantissas below one
  const auto quantise = [](float v, int biased) { return uint32_t(v * detail::powerOfTwo(24 - biased) + 0.5f); };
  if (quantise(largest, exponent) == 512) ++exponent;
  return quantise(r, exponent) | quantise(g, exponent) << 9 | quantise(b, exponent) << 18 | uint32_t(exponent) << 27;
}

// ---- Half: IEEE 754 binary16.

/// Exact; subnormals, infinities and NaN included.
constexpr float unpackHalf(uint16_t h) {
  const uint32_t sign = uint32_t(h & 0x8000u) << 16, magnitude = h & 0x7fffu;
  if (magnitude >= 0x7c00u) return std::bit_cast<float>(sign | 0x7f800000u | (magnitude & 0x3ffu) << 13);
  if (magnitude >= 0x0400u) return std::bit_cast<float>(sign | ((magnitude << 13) + (112u << 23)));
  const float subnormal = float(magnitude) * detail::powerOfTwo(-24);
  return sign ? -subnormal : subnormal;
}

/// Round to nearest, ties to even; overflow becomes infinity, NaN stays NaN.
constexpr uint16_t packHalf(float v) {
  const uint32_t bits = std::bit_cast<uint32_t>(v);
  const uint32_t sign = bits >> 16 & 0x8000u, magnitude = bits & 0x7fffffffu;
  if (magnitude > 0x7f800000u) return uint16_t(sign | 0x7e00u);
  if (magnitude >= 0x477ff000u) return uint16_t(sign | 0x7c00u);  // 65520 and more round to infinity
  if (magnitude < 0x38800000u) {                                    // below 2^-14: subnormal. Adding 0.5 aligns the mantissa and rounds
    const float aligned = std::bit_cast<float>(magnitude) + 0.5f;
    return uint16_t(sign | (std::bit_cast<uint32_t>(aligned) - 0x3f000000u));
  }
  const uint32_t rounded = magnitude + 0xfffu + (magnitude >> 13 & 1u);
  return uint16_t(sign | ((rounded - (112u << 23)) >> 13));
}

// ---- Octahedral unit vectors, two signed normalised 16-bit numbers (value / 32767, −32768 not used by writers).
// Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors" (JCGT 2014), section 3.

struct Oct16 {
  int16_t x = 0, y = 0;
};

/// Unit vector (to float accuracy) of any pair.
inline Float3 unpackOct(Oct16 v) {
  const float px = std::max(float(v.x) / 32767.0f, -1.0f), py = std::max(float(v.y) / 32767.0f, -1.0f);
  const float z = 1.0f - std::abs(px) - std::abs(py);
  const float fold = std::max(-z, 0.0f);
  const float x = px + (px >= 0.0f ? -fold : fold), y = py + (py >= 0.0f ? -fold : fold);
  const float scale = 1.0f / std::sqrt(x * x + y * y + z * z);
  return {x * scale, y * scale, z * scale};
}

/// Nearest grid point in the octahedral plane, halves away from zero: within 1e-4 rad. A zero or non-finite vector becomes +z.
inline Oct16 packOct(Float3 n) {
  const float norm = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
  if (!(norm > 0.0f) || !std::isfinite(norm)) return {};
  float px = n.x / norm, py = n.y / norm;
  if (n.z < 0.0f) {
    const float fx = (1.0f - std::abs(py)) * (px >= 0.0f ? 1.0f : -1.0f);
    py = (1.0f - std::abs(px)) * (py >= 0.0f ? 1.0f : -1.0f);
    px = fx;
  }
  return {int16_t(std::lround(px * 32767.0f)), int16_t(std::lround(py * 32767.0f))};
}

// ---- sRGB bytes (IEC 61966-2-1).

/// Linear value in [0, 1].
inline float decodeSrgb(uint8_t v) {
  const double s = v / 255.0;
  return float(s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4));
}

/// Nearest byte in the encoded scale; clamps to [0, 1], NaN becomes 0. encodeSrgb(decodeSrgb(v)) == v for every v.
inline uint8_t encodeSrgb(float linear) {
  const double l = linear > 0.0f ? std::min(linear, 1.0f) : 0.0f;
  const double s = l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1.0 / 2.4) - 0.055;
  return uint8_t(s * 255.0 + 0.5);
}

}  // namespace lightwell::format
