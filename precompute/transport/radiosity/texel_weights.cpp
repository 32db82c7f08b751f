#include "precompute/transport/radiosity/texel_weights.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace lightwell::transport {
namespace {

constexpr float kLeastCosine = 0.9f;  // between the normals of patches that are mixed: about 25°

}  // namespace

TexelWeights makeTexelWeights(const atlas::Atlas& atlas, const Sides& sides, const Patches& patches) {
  const uint32_t width = uint32_t(atlas.width), k = patches.texels_per_side, columns = (width + k - 1) / k;
  // The fronts' patches by square and chart; within a square, patches of several charts or materials.
  std::unordered_map<uint64_t, std::vector<uint32_t>> in_square;
  const auto slotOf = [&](uint32_t patch) -> const atlas::Slot& { return atlas.slots[sides.slot[patches.sidesOf(patch)[0]]]; };
  for (uint32_t patch = 0; patch < patches.count(); ++patch) {
    if (sides.isBack(patches.sidesOf(patch)[0])) continue;
    const atlas::Slot& slot = slotOf(patch);
    in_square[uint64_t(slot.texel / width / k) * columns + slot.texel % width / k].push_back(patch);
  }
  TexelWeights result;
  for (uint32_t slot_index = 0; slot_index < atlas.slots.size(); ++slot_index) {
    const uint32_t own = patches.patch_of_side[slot_index];
    if (own == kNone) continue;
    const atlas::Slot& slot = atlas.slots[slot_index];
    const float x = (float(slot.texel % width) + 0.5f) / float(k) - 0.5f, y = (float(slot.texel / width) + 0.5f) / float(k) - 0.5f;
    const int x0 = int(std::floor(x)), y0 = int(std::floor(y));
    std::array<uint32_t, 4> patch{kNone, kNone, kNone, kNone};
    std::array<float, 4> weight{};
    float sum = 0;
    for (int i = 0; i < 4; ++i) {
      const int column = x0 + (i & 1), row = y0 + (i >> 1);
      const float share = (i & 1 ? x - float(x0) : 1 - (x - float(x0))) * (i >> 1 ? y - float(y0) : 1 - (y - float(y0)));
      if (column < 0 || row < 0 || share <= 0) continue;
      const auto found = in_square.find(uint64_t(row) * columns + uint32_t(column));
      if (found == in_square.end()) continue;
      const auto same = std::find_if(found->second.begin(), found->second.end(), [&](uint32_t other) {
        return other == own || (slotOf(other).chart == slot.chart && patches.material[other] == patches.material[own] &&
                                patches.normal[other].dot(patches.normal[own]) >= kLeastCosine);
      });
      if (same == found->second.end()) continue;
      patch[i] = *same;
      weight[i] = share;
      sum += share;
    }
    if (sum <= 0) patch[0] = own, weight[0] = sum = 1;
    for (float& w : weight) w /= sum;
    result.slot.push_back(slot_index);
    result.patch.push_back(patch);
    result.weight.push_back(weight);
  }
  return result;
}

}  // namespace lightwell::transport
