// Links in eight bits.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "precompute/transport/radiosity/links.h"

namespace lightwell::transport {
namespace {

/// A row with portals: what rounding leaves of a link goes to the next smaller one of its set. Scaled so that with all portals shut, and with all open, the row receives no more than it
/// should.
void quantiseGatedRow(const LinkValues& links, uint32_t row, RadiosityLinks& result) {
  const uint32_t begin = links.first[row], end = links.first[row + 1];
  double largest = 0;
  for (uint32_t l = begin; l < end; ++l) largest = std::max(largest, double(links.value[l]));
  const double unit = linkWeight(255) / std::max(largest, 1e-30);
  std::vector<uint32_t> order(end - begin);
  std::iota(order.begin(), order.end(), begin);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return links.set[a] != links.set[b] ? links.set[a] < links.set[b] : links.value[a] > links.value[b];
  });
  double rest = 0;
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t l = order[i];
    if (i == 0 || links.set[l] != links.set[order[i - 1]]) rest = 0;
    const double wanted = links.value[l] * unit + rest;
    result.code[l] = linkCode(float(wanted));
    rest = wanted - linkWeight(result.code[l]);
  }
  double scale = 1 / unit;
  for (const GateClass state : {GateClass::closed, GateClass::open}) {
    double sum = 0, codes = 0;
    for (uint32_t l = begin; l < end; ++l) {
      const GateClass gates = links.sets.classOf(links.set[l]);
      if (gates != GateClass::always && gates != state) continue;
      sum += links.value[l];
      codes += linkWeight(result.code[l]);
    }
    if (codes > 0) scale = std::min(scale, sum / codes);
  }
  result.row_scale[row] = begin < end ? float(scale) : 0.0f;
}

}  // namespace

uint8_t linkCode(float weight) {
  if (weight <= 16.0f) return 0;
  int exponent = std::ilogb(weight) - 4;
  int mantissa = int(std::lround(std::ldexp(weight, -exponent))) - 16;
  if (mantissa == 16) mantissa = 0, ++exponent;
  return exponent > 15 ? 255 : uint8_t(exponent << 4 | mantissa);
}

RadiosityLinks quantiseLinks(const LinkValues& links) {
  RadiosityLinks result;
  result.first = links.first;
  result.node = links.node;
  result.set = links.set;
  result.sets = links.sets;
  result.code.resize(links.node.size());
  result.row_scale.resize(links.rows());
  for (uint32_t row = 0; row < links.rows(); ++row) {
    if (!links.set.empty()) {
      quantiseGatedRow(links, row, result);
      continue;
    }
    double sum = 0, largest = 0;
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) {
      sum += links.value[l];
      largest = std::max(largest, double(links.value[l]));
    }
    uint64_t codes = 0;
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) {
      result.code[l] = linkCode(float(links.value[l] / largest * linkWeight(255)));
      codes += linkWeight(result.code[l]);
    }
    result.row_scale[row] = codes ? float(sum / double(codes)) : 0.0f;
  }
  return result;
}

}  // namespace lightwell::transport
