#include "precompute/transport/radiosity/texel_weights.h"

#include <algorithm>
#include <cmath>

namespace lightwell::transport {
namespace {

constexpr float kLeastCosine = 0.9f;  // between the normals of patches that are mixed: about 25°

}  // namespace

TexelWeights makeTexelWeights(const atlas::Atlas& atlas, const Sides& sides, const Patches& patches) {
  TexelWeights result;
  for (uint32_t slot_index = 0; slot_index < sides.front_count; ++slot_index) {
    const uint32_t own = patches.patch_of_side[slot_index];
    if (own == kNone) continue;
    const atlas::Slot& slot = atlas.slots[slot_index];
    const int texel_x = int(slot.texel) % atlas.width, texel_y = int(slot.texel) / atlas.width, k = patches.texels_per_side[own];
    // The patch of a neighbouring square of the own one's size: that of its texel nearest to this one.
    const auto patchOfSquare = [&](int column, int row) {
      const int x = std::clamp(texel_x, column * k, column * k + k - 1), y = std::clamp(texel_y, row * k, row * k + k - 1);
      if (column < 0 || row < 0 || x >= atlas.width || y >= atlas.height) return kNone;
      const uint32_t other_slot = atlas.texel_slot[size_t(y) * size_t(atlas.width) + size_t(x)];
      if (other_slot == kNone || atlas.slots[other_slot].chart != slot.chart) return kNone;
      const uint32_t other = patches.patch_of_side[other_slot];
      if (other == kNone || patches.material[other] != patches.material[own] || patches.normal[other].dot(patches.normal[own]) < kLeastCosine) return kNone;
      if (!patches.zone.empty() && !mayMix(patches.zone[own], patches.zone[other])) return kNone;  // not through a shut door
      return other;
    };
    const float x = (float(texel_x) + 0.5f) / float(k) - 0.5f, y = (float(texel_y) + 0.5f) / float(k) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    std::array<uint32_t, 4> patch{own, kNone, kNone, kNone};
    std::array<float, 4> weight{};
    float sum = 0;
    int used = 1;
    for (int i = 0; i < 4; ++i) {
      const int column = x0 + (i & 1), row = y0 + (i >> 1);
      const float share = (i & 1 ? x - float(x0) : 1 - (x - float(x0))) * (i >> 1 ? y - float(y0) : 1 - (y - float(y0)));
      if (share <= 0) continue;
      const uint32_t other = column == texel_x / k && row == texel_y / k ? own : patchOfSquare(column, row);
      if (other == kNone) continue;
      sum += share;
      const auto known = std::find(patch.begin(), patch.begin() + used, other) - patch.begin();
      if (known == used) patch[size_t(used++)] = other;
      weight[size_t(known)] += share;
    }
    for (float& w : weight) w /= sum;
    result.slot.push_back(slot_index);
    result.patch.push_back(patch);
    result.weight.push_back(weight);
  }
  return result;
}

}  // namespace lightwell::transport
