#pragma once
#include <algorithm>

#include "precompute/atlas/atlas.h"

namespace lightwell::transport {

/// What share of a path's light a mean surface reflects, by the brightest channel, as the next reflection finds it. 0 to 0.999; 0 without surfaces.
inline double meanAlbedo(const atlas::Atlas& atlas) {
  double reflected = 0, area = 0;
  for (const auto& slot : atlas.slots) {
    reflected += double(slot.area) * double(maxComponent(slot.albedo_rgb));
    area += double(slot.area);
  }
  return area > 0 ? std::min(reflected / area, 0.999) : 0;
}

}  // namespace lightwell::transport
