// Probes that precomputed radiance maps light. docs/format.md gives the meaning of the container's arrays.
#pragma once
#include "lightwell/lightwell_prm_probes.h"
#include "runtime/src/prm.h"

struct lw_prm_probes {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  lw_prm* prm = nullptr;            // one of its owners
  lightwell::format::PrmProbesHeader header;
  Array<float> position_m;          // [probes][3]
  Array<uint8_t> rank;              // [probes]
  Array<uint32_t> first_rank;       // [probes + 1]: sums of ranks
  Array<int8_t> basis;              // per probe [12][rank]
  Array<float> scale;               // per probe [rank][3]
  Array<uint32_t> first_link;       // [probes + 1]
  Array<uint64_t> first_coefficient;  // [probes]
  Array<uint32_t> wavelet;          // [links]
  Array<int8_t> coefficient;        // per probe [rank][G, R - G, B - G][link]
  Array<uint16_t> emitter;          // [probes][9][3], or empty

  ~lw_prm_probes() { lw_prm_release(prm); }
};

namespace lightwell::runtime {

struct PrmProbeCoefficient {
  int8_t red, green, blue;
};

/// Of a probe's basis map `k` and link `l`, both counted from the probe's first.
inline PrmProbeCoefficient coefficientOf(const lw_prm_probes& p, uint32_t probe, uint32_t k, uint32_t l) {
  const size_t links = p.first_link[probe + 1] - p.first_link[probe];
  const int8_t* green = p.coefficient.data() + p.first_coefficient[probe] + size_t(k) * 3 * links + l;
  const auto sum = [&](int8_t difference) { return int8_t(uint8_t(uint8_t(*green) + uint8_t(difference))); };
  return {sum(green[links]), *green, sum(green[2 * links])};
}

}  // namespace lightwell::runtime
