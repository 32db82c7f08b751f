#include "runtime/src/wavelets.h"

#include <cmath>
#include <cstring>

namespace lightwell::runtime {

const char* WaveletTree::load(const Host& host, uint32_t clusters, const Array<uint32_t>& first_leaves, const Array<uint16_t>& first_share,
                              const Array<uint8_t>& unit, bool& out_of_memory) {
  const uint32_t nodes = clusters - 1;
  Array<uint32_t> range;  // [nodes][2]: first leaf, leaves
  out_of_memory = !child_.allocate(host, size_t(nodes) * 2) || !share_.allocate(host, nodes) || !per_unit_.allocate(host, unit.size()) ||
                  !range.allocate(host, size_t(nodes) * 2);
  if (out_of_memory) return "no memory for the tree of wavelets";
  if (nodes) range[0] = 0, range[1] = clusters;
  for (uint32_t n = 0; n < nodes; ++n) {
    const uint32_t first_leaf = range[n * 2], leaves = range[n * 2 + 1], first = first_leaves[n];
    if (first == 0 || first >= leaves) return "the leaves of a node are not split in two";
    // In pre-order the first child's inner nodes follow, one fewer than its leaves; so ranges are always written before they are read.
    const uint32_t at[2] = {n + 1, n + first}, from[2] = {first_leaf, first_leaf + first}, count[2] = {first, leaves - first};
    for (uint32_t k = 0; k < 2; ++k) {
      child_[n * 2 + k] = count[k] == 1 ? from[k] : clusters + at[k];
      if (count[k] > 1) range[at[k] * 2] = from[k], range[at[k] * 2 + 1] = count[k];
    }
    share_[n] = float(first_share[n]) * 0x1p-16f;
  }
  for (size_t w = 0; w < unit.size(); ++w) per_unit_[w] = std::exp2((160.0f - float(unit[w])) * 0.125f);
  return nullptr;
}

void WaveletTree::transform(const float* cluster_rgb, float* wavelet_rgb) const {
  const uint32_t* child = child_.data();
  const size_t count = clusters();
  std::memcpy(wavelet_rgb, cluster_rgb, count * 3 * sizeof(float));
  for (size_t n = count - 1; n-- > 0;) {
    const float *first = wavelet_rgb + size_t(child[n * 2]) * 3, *second = wavelet_rgb + size_t(child[n * 2 + 1]) * 3, s = share_[n];
    float *mean = wavelet_rgb + (count + n) * 3, *difference = wavelet_rgb + (2 * count - 1 + n) * 3;
    for (int k = 0; k < 3; ++k) {
      mean[k] = s * first[k] + (1 - s) * second[k];
      difference[k] = first[k] - second[k];
    }
  }
  for (size_t w = 0; w < per_unit_.size(); ++w)
    for (size_t k = 0; k < 3; ++k) wavelet_rgb[w * 3 + k] *= per_unit_[w];
}

}  // namespace lightwell::runtime
