// Probes of precomputed radiance maps. Everything that evaluation relies on is checked when they are loaded.
#include "runtime/src/prm_probes.h"

#include <cmath>

#include "format/decode/pixel.h"
#include "runtime/src/harmonics.h"
#include "runtime/src/section_loader.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;

constexpr uint32_t kValues = 12, kMostProbes = 1u << 22;
constexpr float kMostRadiance = 1e30f;

class Loader : SectionLoader {
 public:
  Loader(const lw_container& container, lw_prm_probes& probes) : SectionLoader(container, "prm_probes"), p_(probes) {}

  lw_result load() {
    loadHeader();
    const uint64_t probes = p_.header.probes;
    if (decode("position", ElementType::f32, probes * 3, p_.position_m)) require(allFinite(p_.position_m.data(), probes * 3), "position", "a value is not finite");
    decode("block_rank", ElementType::u8, probes, p_.rank);
    decode("block_first_link", ElementType::u32, probes + 1, p_.first_link);
    if (!result_) loadLinks();
    if (p_.header.has_emitter && decode("emitter", ElementType::f16, probes * 27, p_.emitter))
      for (const uint16_t v : p_.emitter) require((v & 0x7c00u) != 0x7c00u, "emitter", "a value is not finite");
    return result_;
  }

 private:
  void loadHeader() {
    result_ = readHeader(container_, section_, [&](const Array<uint8_t>& message) { return format::parsePrmProbesHeader(message.data(), message.size(), p_.header); });
    require(p_.header.probes > 0 && p_.header.probes <= kMostProbes && p_.header.max_rank <= kValues, "header", "its counts cannot be");
  }

  void loadLinks() {
    const uint32_t probes = p_.header.probes, links = p_.first_link[probes];
    require(areOffsets(p_.first_link, links), "block_first_link", "it does not split the links");
    if (!allocate(p_.first_rank, size_t(probes) + 1) || !allocate(p_.first_coefficient, probes)) return;
    uint64_t coefficients = 0;
    p_.first_rank[0] = 0;
    for (uint32_t i = 0; i < probes; ++i) {
      require(p_.rank[i] <= p_.header.max_rank, "block_rank", "a rank is above the header's maximum");
      p_.first_rank[i + 1] = p_.first_rank[i] + p_.rank[i];
      p_.first_coefficient[i] = coefficients;
      coefficients += uint64_t(p_.rank[i]) * (p_.first_link[i + 1] - p_.first_link[i]) * 3;
    }
    const uint64_t ranks = p_.first_rank[probes];
    decode("basis", ElementType::i8, ranks * kValues, p_.basis);
    decode("coefficient", ElementType::i8, coefficients, p_.coefficient);
    if (decode("coefficient_scale", ElementType::f32, ranks * 3, p_.scale)) require(allFinite(p_.scale.data(), ranks * 3), "coefficient_scale", "a value is not finite");
    if (!decode("link_wavelet", ElementType::u32, links, p_.wavelet)) return;
    bool good = true;
    for (const uint32_t w : p_.wavelet) good &= w < p_.prm->tree.wavelets();
    require(good, "link_wavelet", "a link is no wavelet");
  }

  lw_prm_probes& p_;
};

float sane(double v) { return v > -kMostRadiance && v < kMostRadiance ? float(v) : 0.0f; }

/// Values at the corners of an icosahedron, (0, ±1, ±φ) / |…| and its cyclic shifts, to integrals of radiance times Y.
void addHarmonics(const double (*value)[3], double (*sh)[3]) {
  constexpr float kShort = 0.525731112f, kLong = 0.850650808f, kPerBand[3] = {1.0f / 3, 0.5f, 4.0f / 3};  // (4π / 12) over π, 2π / 3, π / 4
  for (uint32_t i = 0; i < kValues; ++i) {
    float n[3] = {}, y[kHarmonics];
    n[(i / 4 + 1) % 3] = i & 2 ? -kShort : kShort;
    n[(i / 4 + 2) % 3] = i & 1 ? -kLong : kLong;
    harmonics(n[0], n[1], n[2], y);
    for (uint32_t k = 0; k < kHarmonics; ++k)
      for (int c = 0; c < 3; ++c) sh[k][c] += value[i][c] * double(y[k] * kPerBand[k == 0 ? 0 : k < 4 ? 1 : 2]);
  }
}

void evaluateProbe(const lw_prm_probes& p, const float* wavelet_rgb, uint32_t probe, bool emitters, float (*sh)[3]) {
  const uint32_t rank = p.rank[probe], first = p.first_link[probe], links = p.first_link[probe + 1] - first;
  const int8_t* basis = p.basis.data() + size_t(p.first_rank[probe]) * kValues;
  double value[kValues][3] = {}, sum[kHarmonics][3] = {};
  for (uint32_t k = 0; k < rank; ++k) {
    double amount[3] = {};
    for (uint32_t l = 0; l < links; ++l) {
      const float* light = wavelet_rgb + size_t(p.wavelet[first + l]) * 3;
      const PrmProbeCoefficient coefficient = coefficientOf(p, probe, k, l);
      amount[0] += double(coefficient.red) * double(light[0]);
      amount[1] += double(coefficient.green) * double(light[1]);
      amount[2] += double(coefficient.blue) * double(light[2]);
    }
    for (uint32_t i = 0; i < kValues; ++i)
      for (uint32_t c = 0; c < 3; ++c) value[i][c] += double(basisValue(basis[i * rank + k])) * amount[c] * double(p.scale[(p.first_rank[probe] + k) * 3 + c]);
  }
  addHarmonics(value, sum);
  for (uint32_t k = 0; k < kHarmonics; ++k)
    for (uint32_t c = 0; c < 3; ++c)
      sh[k][c] = sane(sum[k][c] + (emitters ? double(format::unpackHalf(p.emitter[(size_t(probe) * kHarmonics + k) * 3 + c])) : 0.0));
  keepIrradiancePositive(sh);
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_prm_probes_load(const lw_container* container, const lw_prm* prm, lw_prm_probes** out) {
  if (!container || !prm || !out) return LW_INVALID_ARGUMENT;
  if (!prm->pane_sum_rgb.empty()) return container->host.fail(LW_INVALID_ARGUMENT, "panes light no probes");
  lw_prm_probes* probes = createHandle<lw_prm_probes>(container->host);
  if (!probes) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the probes");
  probes->prm = retain(*prm);
  if (const lw_result result = Loader(*container, *probes).load()) {
    destroyHandle(probes);
    return result;
  }
  *out = probes;
  return LW_OK;
}

void lw_prm_probes_release(lw_prm_probes* probes) {
  if (probes) destroyHandle(probes);
}

lw_result lw_prm_probes_get_info(const lw_prm_probes* probes, lw_prm_probes_info* info) {
  if (!probes || !info) return LW_INVALID_ARGUMENT;
  *info = {probes->header.probes, !probes->emitter.empty(), probes->position_m.data()};
  return LW_OK;
}

size_t lw_prm_probes_scratch_bytes(const lw_prm_probes* probes) { return probes ? probes->prm->tree.wavelets() * 3 * sizeof(float) : 0; }

lw_result lw_prm_probes_evaluate(const lw_prm_probes* probes, const float* cluster_irradiance_rgb, const lw_prm_probes_evaluation* given, void* scratch, size_t scratch_bytes,
                                 float* radiance_sh) {
  if (!probes || !cluster_irradiance_rgb || !radiance_sh) return LW_INVALID_ARGUMENT;
  const lw_prm_probes_evaluation evaluation = given ? *given : lw_prm_probes_evaluation LW_PRM_PROBES_EVALUATION_INIT;
  const Host& host = probes->host;
  if (evaluation.size < sizeof evaluation || evaluation.emitters > 1 || (evaluation.count > 0 && !evaluation.probe))
    return host.fail(LW_INVALID_ARGUMENT, "lw_prm_probes_evaluation: a value is out of range");
  const uint32_t count = evaluation.probe ? evaluation.count : probes->header.probes;
  for (uint32_t i = 0; evaluation.probe && i < count; ++i)
    if (evaluation.probe[i] >= probes->header.probes) return host.fail(LW_NOT_FOUND, "the container has no probe %u", evaluation.probe[i]);
  const size_t needed = lw_prm_probes_scratch_bytes(probes);
  if (scratch_bytes < needed || !scratch) return host.fail(LW_INVALID_ARGUMENT, "%zu bytes of scratch are needed, not %zu", needed, scratch_bytes);
  if (!isIrradiance(cluster_irradiance_rgb, size_t(probes->prm->header.clusters) * 3)) return host.fail(LW_INVALID_ARGUMENT, "an irradiance is negative or not finite");
  float* wavelet_rgb = static_cast<float*>(scratch);
  probes->prm->tree.transform(cluster_irradiance_rgb, wavelet_rgb);
  for (uint32_t i = 0; i < count; ++i)
    evaluateProbe(*probes, wavelet_rgb, evaluation.probe ? evaluation.probe[i] : i, evaluation.emitters && !probes->emitter.empty(),
                  reinterpret_cast<float(*)[3]>(radiance_sh + size_t(i) * kHarmonics * 3));
  return LW_OK;
}
