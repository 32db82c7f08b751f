// Low-discrepancy random numbers keyed by (seed, owner, sample, dimension), never by thread, so that every result is
// the same for any number of threads. Owen-scrambled Sobol points in padded 2D pairs after Burley,
// "Practical Hash-based Owen Scrambling" (JCGT 2020): nested uniform scrambling by a hash on reversed bits.
#pragma once
#include <cstdint>

#include "precompute/core/math.h"

namespace lightwell {

/// A well-mixed 32-bit hash of a 64-bit key (the finaliser of SplitMix64; Steele et al. 2014).
inline uint32_t mixBits(uint64_t v) {
  v += 0x9e3779b97f4a7c15ull;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9ull;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebull;
  return uint32_t((v ^ (v >> 31)) >> 32);
}
inline uint64_t combineKeys(uint64_t a, uint64_t b) { return (a ^ (b + 0x9e3779b97f4a7c15ull + (a << 6) + (a >> 2))) * 0xff51afd7ed558ccdull; }

inline uint32_t reverseBits(uint32_t v) {
  v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  return __builtin_bswap32(v);
}

/// Owen scrambling of a bit-reversed value: every bit is flipped by a hash of the bits above it (Burley, listing 3 in spirit;
/// constants of Vegdahl's improved Laine-Karras hash).
inline uint32_t owenScramble(uint32_t v, uint32_t seed) {
  v = reverseBits(v);
  v ^= v * 0x3d20adeau;
  v += seed;
  v *= (seed >> 16) | 1u;
  v ^= v * 0x05526c56u;
  v ^= v * 0x53a22864u;
  return reverseBits(v);
}

/// One stream of samples: a texel's, a path's, an entry point's.
class Sampler {
 public:
  /// `owner` names the stream (texel index, path number …) within the bake's `seed`.
  Sampler(uint64_t seed, uint64_t owner) : key_(combineKeys(seed, owner)) {}

  /// The `sample`-th point of the 2D pair number `dimension`, in [0, 1)². Any power-of-two prefix is a (0, 2) net.
  Vec2 get2D(uint32_t sample, uint32_t dimension) const {
    const uint64_t pair_key = combineKeys(key_, dimension);
    const uint32_t index = owenScramble(sample, mixBits(pair_key));
    const uint32_t x = owenScramble(reverseBits(index), mixBits(pair_key ^ 0x68bc21ebull));
    const uint32_t y = owenScramble(sobolSecond(index), mixBits(pair_key ^ 0x02e5be93ull));
    return {toUnit(x), toUnit(y)};
  }
  /// The `sample`-th point of the 1D dimension number `dimension`, in [0, 1).
  float get1D(uint32_t sample, uint32_t dimension) const {
    const uint64_t key = combineKeys(key_, 0x5851f42dull + dimension);
    const uint32_t index = owenScramble(sample, mixBits(key));
    return toUnit(owenScramble(reverseBits(index), mixBits(key ^ 0x68bc21ebull)));
  }

 private:
  static float toUnit(uint32_t v) { return float(v >> 8) * 0x1p-24f; }
  /// The second Sobol dimension: the binary Pascal matrix times the reversed index, by halves instead of bit by bit.
  static uint32_t sobolSecond(uint32_t index) {
    uint32_t v = reverseBits(index);
    v ^= (v << 1) & 0xaaaaaaaau;
    v ^= (v << 2) & 0xccccccccu;
    v ^= (v << 4) & 0xf0f0f0f0u;
    v ^= (v << 8) & 0xff00ff00u;
    return v ^ (v << 16);
  }
  uint64_t key_;
};

/// A direction about +z with density cos(theta)/pi (solid angle), by the concentric map; z ≥ 0.
inline Vec3 sampleCosineHemisphere(const Vec2& u) {
  const float a = 2.0f * u.x - 1.0f, b = 2.0f * u.y - 1.0f;
  float r = 0.0f, phi = 0.0f;
  if (a != 0.0f || b != 0.0f) {
    if (std::abs(a) > std::abs(b)) {
      r = a;
      phi = (kPi / 4.0f) * (b / a);
    } else {
      r = b;
      phi = kPi / 2.0f - (kPi / 4.0f) * (a / b);
    }
  }
  const float x = r * std::cos(phi), y = r * std::sin(phi);
  return {x, y, std::sqrt(std::max(0.0f, 1.0f - x * x - y * y))};
}

/// Uniform barycentrics (b0, b1) of a triangle from [0,1)²; the third is 1 − b0 − b1. Heitz's low-distortion square-to-triangle map (2019).
inline Vec2 sampleTriangle(const Vec2& u) {
  Vec2 b;
  if (u.y > u.x) {
    b.x = u.x * 0.5f;
    b.y = u.y - b.x;
  } else {
    b.y = u.y * 0.5f;
    b.x = u.x - b.y;
  }
  return b;
}

}  // namespace lightwell
