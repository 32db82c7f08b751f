// A clear sky with a sun, as a latitude-longitude map.
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/core/math.h"

namespace lightwell::samples {

struct SkyMap {
  int width = 0, height = 0;
  std::vector<Rgb> radiance_rgb;  // row 0 at the zenith; u = 1/2 + atan2(z, x) / 2 pi
};

/// The standard clear sky of the CIE (type 12 of CIE S 011/E:2003), its zenith 1, with a sun of the true size that gives four times the
/// sky's irradiance on the ground, over ground of albedo 0.2. `sun_direction`: unit, above the horizon.
SkyMap makeClearSky(const Vec3& sun_direction, int width, int height);

/// The bytes of a Radiance file (.hdr), run-length encoded.
std::vector<uint8_t> encodeHdr(const SkyMap& map);

}  // namespace lightwell::samples
