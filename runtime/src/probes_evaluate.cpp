// What probes receive from the patches, as spherical harmonics that no normal sees negative.
#include <algorithm>
#include <cmath>

#include "format/decode/pixel.h"
#include "runtime/src/harmonics.h"
#include "runtime/src/probes.h"

namespace lightwell::runtime {
namespace {

/// How much of the links with each gate set counts.
void gateSetFactors(const lw_probes& p, const lw_radiosity_state& state, Array<float>& factor) {
  for (uint32_t s = 0; s < p.gate_sets; ++s) {
    factor[s] = 1;
    for (uint32_t e = p.gate_set_first.empty() ? 0 : p.gate_set_first[s]; !p.gate_set_first.empty() && e < p.gate_set_first[s + 1]; ++e) {
      const float open = state.gate_open[p.gate_set[e] / 2];
      factor[s] *= p.gate_set[e] & 1 ? 1 - open : open;
    }
  }
}

/// Integrals of radiance times the first `coefficients` Y.
template <uint32_t coefficients>
void gatherProbe(const lw_probes& p, const Float4* node, const Array<float>& set_factor, uint32_t probe, float (*sh)[3]) {
  float sum[kHarmonics][4] = {};
  uint32_t l = p.first_run[probe] > 0 ? p.run[p.first_run[probe] - 1].end_link : 0;
  for (uint32_t r = p.first_run[probe]; r < p.first_run[probe + 1]; l = p.run[r++].end_link) {
    const float factor = set_factor[p.run[r].gate_set];
    if (!(factor > 0)) continue;
    for (uint32_t i = l; i < p.run[r].end_link; ++i) {
      const ProbeLink link = p.link[i];
      const format::Float3 d = format::unpackOct({int16_t(link.direction & 0xffffu), int16_t(link.direction >> 16)});
      float basis[kHarmonics];
      harmonics(d.x, d.y, d.z, basis);
      const float weight = factor * linkWeight(link.node_code & 255);
      Float4 b = node[link.node_code >> 8];
      for (float& v : b.v) v *= weight;
      for (uint32_t k = 0; k < coefficients; ++k)
        for (int c = 0; c < 4; ++c) sum[k][c] += basis[k] * b.v[c];
    }
  }
  // Shares of the sphere, radiosities over π: 4π / π.
  const float scale = 4 * p.scale[probe];
  for (uint32_t k = 0; k < kHarmonics; ++k)
    for (int c = 0; c < 3; ++c) {
      const float v = sum[k][c] * scale;
      sh[k][c] = v > -kMostRadiosity && v < kMostRadiosity ? v : 0.0f;
    }
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_probes_evaluate(const lw_probes* probes, lw_radiosity_state* state, const lw_probes_evaluation* given, float* radiance_sh) {
  if (!probes || !state || !radiance_sh) return LW_INVALID_ARGUMENT;
  const lw_probes_evaluation evaluation = given ? *given : lw_probes_evaluation LW_PROBES_EVALUATION_INIT;
  const Host& host = state->host;
  if (evaluation.size < sizeof evaluation || !evaluation.light || evaluation.light > (LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS) ||
      (evaluation.coefficients != 4 && evaluation.coefficients != 9) || (evaluation.count > 0 && !evaluation.probe))
    return host.fail(LW_INVALID_ARGUMENT, "lw_probes_evaluation: a value is out of range");
  const lw_radiosity& r = *state->radiosity;
  if (probes->patches != r.patches() || probes->nodes != r.nodes() || probes->gates != r.gates) return host.fail(LW_INVALID_ARGUMENT, "the state is of other form factors");
  const uint32_t count = evaluation.probe ? evaluation.count : probes->probes();
  for (uint32_t i = 0; evaluation.probe && i < count; ++i)
    if (evaluation.probe[i] >= probes->probes()) return host.fail(LW_NOT_FOUND, "the container has no probe %u", evaluation.probe[i]);
  Array<float> set_factor;
  if (!set_factor.allocate(host, probes->gate_sets)) return host.fail(LW_OUT_OF_MEMORY, "no memory for %u gate sets", probes->gate_sets);
  gateSetFactors(*probes, *state, set_factor);
  patchRadiosity(*state, state->irradiance.data(), state->node.data(), evaluation.light);
  averageNodes(r, state->node.data());
  for (uint32_t i = 0; i < count; ++i) {
    float(*sh)[3] = reinterpret_cast<float(*)[3]>(radiance_sh + size_t(i) * kHarmonics * 3);
    const auto gather_one = evaluation.coefficients == 9 ? gatherProbe<9> : gatherProbe<4>;
    gather_one(*probes, state->node.data(), set_factor, evaluation.probe ? evaluation.probe[i] : i, sh);
    keepIrradiancePositive(sh);
  }
  return LW_OK;
}
