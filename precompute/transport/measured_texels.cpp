#include "precompute/transport/measured_texels.h"

#include "precompute/core/random.h"
#include "precompute/transport/mean_albedo.h"

namespace lightwell::transport {
namespace {

constexpr uint64_t kChoiceStream = 14ull << 40;
constexpr double kMostPaths = 64, kLeastPaths = 4;
constexpr double kMostRays = 6 * kMostPaths;  // of a texel in a reference, about

}  // namespace

MeasuredTexels chooseTexels(std::span<const uint32_t> density, uint32_t most, uint64_t seed) {
  MeasuredTexels chosen;
  if (density.size() <= most) {
    for (uint32_t slot = 0; slot < density.size(); ++slot) chosen.slot.push_back(slot), chosen.weight.push_back(1);
    return chosen;
  }
  double total = 0;
  for (const uint32_t d : density) total += d;
  // At equal steps through the sum: neighbours are not all chosen together.
  double next = (double(Sampler(seed, kChoiceStream).get1D(0, 0)) + 1e-9) * total / most, sum = 0;
  for (uint32_t slot = 0; slot < density.size(); ++slot) {
    sum += density[slot];
    uint32_t times = 0;
    for (; next < sum; next += total / most) ++times;
    if (times == 0) continue;
    chosen.slot.push_back(slot);
    chosen.weight.push_back(float(times * (total / most) / density[slot]));
  }
  return chosen;
}

double raysPerPath(const atlas::Atlas& atlas) { return 2 / (1 - meanAlbedo(atlas)); }

uint32_t measuringPaths(const atlas::Atlas& atlas) { return uint32_t(std::clamp(kMostRays / raysPerPath(atlas), kLeastPaths, kMostPaths)); }

}  // namespace lightwell::transport
