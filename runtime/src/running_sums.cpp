#include "runtime/src/running_sums.h"

#include <algorithm>
#include <cmath>

namespace lightwell::runtime {

bool RunningSums::allocate(const Host& host, const lw_prm& prm) {
  if (!scratch_.allocate(host, SumMemory::floats(prm))) return false;
  SumMemory(prm, scratch_.data()).clear(prm);
  return true;
}

void RunningSums::forget(const lw_prm& prm) { std::memset(SumMemory(prm, scratch_.data()).touched, 0, SumMemory::pieces(prm)); }

bool RunningSums::touched(const lw_prm& prm, size_t block) const {
  const size_t pieces = prm.links.stride() / 8;
  const uint8_t* of_block = SumMemory(prm, const_cast<float*>(scratch_.data())).touched + block * pieces;
  return std::any_of(of_block, of_block + pieces, [](uint8_t t) { return t != 0; });
}

void RunningSums::update(const lw_prm& prm, const float* cluster_rgb, float tolerance) {
  // Differences of floats leave their rounding behind: it is swept out before it can add up, and before it can outshine a light that is left.
  constexpr uint32_t kMostUpdates = 64;
  constexpr float kMostContrast = 1000;
  SumMemory memory(prm, scratch_.data());
  prm.tree.transform(cluster_rgb, memory.wavelet_rgb);
  float brightest = 0;
  int32_t lit = 0, changed = 0;  // numbers of the wavelets
#pragma omp simd reduction(max : brightest) reduction(+ : lit, changed)
  for (size_t i = 0; i < prm.tree.wavelets() * 3; ++i) {
    const float to = memory.wavelet_rgb[i], bright = std::fabs(to);
    brightest = brightest > bright ? brightest : bright;
    lit += to != 0;
    changed += to != memory.applied_rgb[i];
  }
  if (++updates_ > kMostUpdates || lit < changed || brightest * kMostContrast < brightest_) {
    memory.clear(prm);
    std::memset(memory.touched, 1, SumMemory::pieces(prm));
    updates_ = 0;
    brightest_ = 0;
  }
  brightest_ = std::max(brightest_, brightest);
  prm.links.update(memory.change(), tolerance);
}

}  // namespace lightwell::runtime
