#include "precompute/transport/prm/hemisphere_bundle.h"

#include <algorithm>
#include <utility>

#include "precompute/core/random.h"

namespace lightwell::transport {
namespace {

/// The bits of both numbers, both below 2¹⁶, in turn.
uint32_t zOrder(uint32_t x, uint32_t y) {
  uint32_t code = 0;
  for (uint32_t bit = 0; bit < 16; ++bit) code |= (x >> bit & 1) << (2 * bit) | (y >> bit & 1) << (2 * bit + 1);
  return code;
}

}  // namespace

HemisphereBundle::HemisphereBundle(uint32_t count, uint64_t seed, uint64_t owner) {
  const Sampler sampler(seed, owner);
  std::vector<std::pair<uint32_t, uint32_t>> order;  // place on the curve, sample
  for (uint32_t i = 0; i < count; ++i) {
    const Vec2 u = sampler.get2D(i, 0);
    order.emplace_back(zOrder(uint32_t(u.x * 0x1p16f), uint32_t(u.y * 0x1p16f)), i);
  }
  std::sort(order.begin(), order.end());
  for (const auto& [place, i] : order) directions.push_back(sampleCosineHemisphere(sampler.get2D(i, 0)));
}

}  // namespace lightwell::transport
