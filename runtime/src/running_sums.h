// The sums of local bases from frame to frame: what has not changed is not summed again.
#pragma once
#include "runtime/src/prm.h"

namespace lightwell::runtime {

class RunningSums {
 public:
  /// False when there is no memory.
  bool allocate(const Host& host, const lw_prm& prm);

  /// Brings the sums to the light `cluster_rgb`, [clusters][3], up to `tolerance` of its root mean square.
  void update(const lw_prm& prm, const float* cluster_rgb, float tolerance);

  /// [PrmLinks::stride()] of a block.
  const float* sums(const lw_prm& prm, size_t block) const { return SumMemory(prm, const_cast<float*>(scratch_.data())).sums + block * prm.links.stride(); }
  /// Whether a block's sums changed since the last forget().
  bool touched(const lw_prm& prm, size_t block) const;
  void forget(const lw_prm& prm);

 private:
  Array<float> scratch_;  // SumMemory
  uint32_t updates_ = 0;  // since all was summed anew
  float brightest_ = 0;   // wavelet in those updates
};

}  // namespace lightwell::runtime
