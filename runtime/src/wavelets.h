// Light on the clusters of a precomputed radiance map at all scales at once, over a tree of them: docs/format.md, section prm.
#pragma once
#include "runtime/src/host.h"

namespace lightwell::runtime {

/// The tree as evaluation walks it. Of c clusters, wavelets [0, c) are the light on each, c + n is the mean over inner node n, and 2 c - 1 + n the mean over its
/// first child less that over its second.
class WaveletTree {
 public:
  /// `first_leaves`, `first_share`: [clusters - 1]; `unit`: [wavelets]. Null when all is well, else what is wrong; `out_of_memory` tells which kind.
  const char* load(const Host& host, uint32_t clusters, const Array<uint32_t>& first_leaves, const Array<uint16_t>& first_share, const Array<uint8_t>& unit,
                   bool& out_of_memory);

  static uint64_t wavelets(uint32_t clusters) { return uint64_t(clusters) * 3 - 2; }
  uint32_t clusters() const { return uint32_t(share_.size()) + 1; }
  size_t wavelets() const { return per_unit_.size(); }
  /// `cluster_rgb`: [clusters][3]. `wavelet_rgb`: receives [wavelets][3], each in its unit.
  void transform(const float* cluster_rgb, float* wavelet_rgb) const;

 private:
  Array<uint32_t> child_;  // [clusters - 1][2]: the wavelets that are the children's means
  Array<float> share_;     // [clusters - 1]
  Array<float> per_unit_;  // [wavelets]
};

}  // namespace lightwell::runtime
