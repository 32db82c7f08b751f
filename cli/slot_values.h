// From an atlas as the runtime fills it to the values of the surface's texels.
#pragma once
#include <vector>

#include "precompute/atlas/atlas.h"

namespace lightwell::cli {

/// RGB of every slot's texel, in the order of the slots. `atlas_rgba`: [height][width][4] of the same atlas.
inline std::vector<Rgb> valuesOfSlots(const atlas::Atlas& atlas, const std::vector<float>& atlas_rgba) {
  std::vector<Rgb> values;
  for (const atlas::Slot& slot : atlas.slots) {
    const float* texel = &atlas_rgba[size_t(slot.texel) * 4];
    values.push_back({texel[0], texel[1], texel[2]});
  }
  return values;
}

}  // namespace lightwell::cli
