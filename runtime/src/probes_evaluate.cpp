// What probes receive from the patches, as spherical harmonics that no normal sees negative.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/probes.h"

namespace lightwell::runtime {
namespace {

constexpr uint32_t kHarmonics = 9;
constexpr float kPi = 3.14159265f;

void harmonics(float x, float y, float z, float* basis) {
  const float values[kHarmonics] = {0.28209479f, 0.48860251f * y, 0.48860251f * z, 0.48860251f * x, 1.09254843f * x * y,
                                    1.09254843f * y * z, 0.31539157f * (3 * z * z - 1), 1.09254843f * x * z, 0.54627422f * (x * x - y * y)};
  std::memcpy(basis, values, sizeof values);
}

/// The irradiance of one channel about n: linear · n + quadratic in n + mean.
struct Irradiance {
  float x, y, z, mean, xy, yz, zz, zx, xx_yy;

  explicit Irradiance(const float (*sh)[3], int channel) {
    constexpr float a1 = 0.48860251f * 2 * kPi / 3, a2 = 1.09254843f * kPi / 4;
    x = a1 * sh[3][channel], y = a1 * sh[1][channel], z = a1 * sh[2][channel], mean = 0.28209479f * kPi * sh[0][channel];
    xy = a2 * sh[4][channel], yz = a2 * sh[5][channel], zz = 0.31539157f * kPi / 4 * sh[6][channel], zx = a2 * sh[7][channel], xx_yy = a2 / 2 * sh[8][channel];
  }
  float curvature() const { return std::abs(xy) + std::abs(yz) + 6 * std::abs(zz) + std::abs(zx) + 2 * std::abs(xx_yy); }
  float about(const float* n) const {
    return mean + x * n[0] + y * n[1] + z * n[2] + xy * n[0] * n[1] + yz * n[1] * n[2] + zz * (3 * n[2] * n[2] - 1) + zx * n[0] * n[2] +
           xx_yy * (n[0] * n[0] - n[1] * n[1]);
  }
  /// Over all unit normals, within what a few steps reach.
  float least() const {
    float best[3] = {}, least = INFINITY;
    for (int k = 0; k < 27; ++k) {
      const float n[3] = {float(k % 3 - 1), float(k / 3 % 3 - 1), float(k / 9 - 1)};
      const float length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
      if (length == 0) continue;
      const float u[3] = {n[0] / length, n[1] / length, n[2] / length}, value = about(u);
      if (value < least) least = value, std::memcpy(best, u, sizeof best);
    }
    // Less the curvature the function is concave: its tangent lies above it, and the least value of the tangent is known.
    const float k = curvature();
    for (int step = 0; step < 8; ++step) {
      const float g[3] = {x + xy * best[1] + zx * best[2] + 2 * xx_yy * best[0], y + xy * best[0] + yz * best[2] - 2 * xx_yy * best[1],
                          z + yz * best[1] + 6 * zz * best[2] + zx * best[0]};
      float n[3], length2 = 0;
      for (int i = 0; i < 3; ++i) n[i] = k * best[i] - g[i], length2 += n[i] * n[i];
      if (!(length2 > 0)) break;
      for (int i = 0; i < 3; ++i) best[i] = n[i] / std::sqrt(length2);
    }
    return std::min(least, about(best));
  }
};

/// Scales all bands but the first until irradiance is nowhere negative: a window (Sloan: "Stupid Spherical Harmonics (SH) Tricks", 2008, section Ringing) as narrow as this light needs. The
/// mean stays.
void window(float (*sh)[3]) {
  for (int c = 0; c < 3; ++c) {
    const Irradiance irradiance(sh, c);
    const float linear = std::sqrt(irradiance.x * irradiance.x + irradiance.y * irradiance.y + irradiance.z * irradiance.z);
    if (linear + irradiance.curvature() <= irradiance.mean) continue;
    const float least = irradiance.least();
    if (least >= 0) continue;
    const float scale = irradiance.mean > 0 ? irradiance.mean / (irradiance.mean - 1.001f * least) : 0.0f;
    for (uint32_t k = 1; k < kHarmonics; ++k) sh[k][c] *= scale;
  }
}

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
    window(sh);
  }
  return LW_OK;
}
