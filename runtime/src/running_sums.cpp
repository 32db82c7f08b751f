#include "runtime/src/running_sums.h"

#include <algorithm>
#include <cmath>

namespace lightwell::runtime {

bool RunningSums::allocate(const Host& host, const lw_prm& prm) {
  if (!scratch_.allocate(host, SumMemory::floats(prm))) return false;
  SumMemory(prm, scratch_.data()).clear(prm);
  return true;
}

void RunningSums::forget(const lw_prm& prm) { std::memset(SumMemory(prm, scratch_.data()).touched, 0, prm.links.blocks()); }

void RunningSums::update(const lw_prm& prm, const float* cluster_rgb, float tolerance) {
  // Differences of floats leave their rounding behind: it is swept out before it can add up, and before it can outshine a light that is left.
  constexpr uint32_t kMostUpdates = 64;
  constexpr float kMostContrast = 1000;
  SumMemory memory(prm, scratch_.data());
  prm.tree.transform(cluster_rgb, memory.wavelet_rgb);
  float brightest = 0;
  size_t lit = 0, changed = 0;
  for (size_t w = 0; w < prm.tree.wavelets(); ++w) {
    const float *to = memory.wavelet_rgb + w * 3, *from = memory.applied_rgb + w * 3;
    brightest = std::max({brightest, std::fabs(to[0]), std::fabs(to[1]), std::fabs(to[2])});
    lit += to[0] != 0 || to[1] != 0 || to[2] != 0;
    changed += to[0] != from[0] || to[1] != from[1] || to[2] != from[2];
  }
  if (++updates_ > kMostUpdates || lit < changed || brightest * kMostContrast < brightest_) {
    memory.clear(prm);
    std::memset(memory.touched, 1, prm.links.blocks());
    updates_ = 0;
    brightest_ = 0;
  }
  brightest_ = std::max(brightest_, brightest);
  prm.links.update(memory.wavelet_rgb, tolerance, memory.applied_rgb, memory.sums, memory.touched);
}

}  // namespace lightwell::runtime
