// What a game changes: materials, portals, direct light; and one sweep over the links.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/radiosity.h"

namespace lightwell::runtime {
namespace {

constexpr float kPi = 3.14159265358979f;

constexpr struct WeightTable {
  float weight[256];
  constexpr WeightTable() : weight() {
    for (uint32_t code = 0; code < 256; ++code) weight[code] = linkWeight(code);
  }
} kWeights;

bool isAmount(const float* values, size_t count) {
  bool good = true;
  for (size_t i = 0; i < count; ++i) good &= values[i] >= 0.0f && values[i] <= LW_RADIOSITY_MOST;
  return good;
}

/// Albedo and emission of the patches with this material.
void applyMaterial(lw_radiosity_state& state, uint32_t material) {
  const lw_radiosity& r = *state.radiosity;
  const lw_radiosity_material& m = state.material[material];
  for (size_t i = 0; i < r.patches(); ++i) {
    if (r.patch_material[i] != material) continue;
    for (int k = 0; k < 3; ++k) {
      state.albedo[i].v[k] = std::min(r.patch_albedo_rgb[i * 3 + k] * m.albedo_factor_rgb[k] + m.albedo_rgb[k], kMostAlbedo);
      state.emitted[i].v[k] = kPi * std::min(r.patch_emission_rgb[i * 3 + k] * m.emission_factor_rgb[k] + m.emission_rgb[k], LW_RADIOSITY_MOST);
    }
    state.albedo[i].v[3] = state.emitted[i].v[3] = 0;
  }
}

void materialsChanged(lw_radiosity_state& state) {
  state.emitter_irradiance_valid = false;
  state.emits = false;
  for (const Float4& e : state.emitted) state.emits |= e.v[0] + e.v[1] + e.v[2] > 0;
}

void gatesChanged(lw_radiosity_state& state) {
  state.emitter_irradiance_valid = false;
  const lw_radiosity& r = *state.radiosity;
  state.gate_set_factor[0] = 1;
  for (uint32_t s = 1; s < r.gate_sets; ++s) {
    float factor = 1;
    for (uint32_t e = r.gate_set_first[s]; e < r.gate_set_first[s + 1]; ++e) {
      const float open = state.gate_open[r.gate_set[e] / 2];
      factor *= r.gate_set[e] & 1 ? 1 - open : open;
    }
    state.gate_set_factor[s] = factor;
  }
}

/// Within ±kMostRadiosity. Negative numbers are extrapolated ones, on the solver's way to the solution.
inline float finite(float v) { return !(v < kMostRadiosity) ? kMostRadiosity : std::max(v, -kMostRadiosity); }

/// Links [begin, end) into `sum`. Two sums take turns, which halves both the rounding and the wait for each addition.
inline void addLinks(const uint32_t* link, size_t begin, size_t end, const Float4* node, float factor, float* sum) {
  float a[4] = {}, b[4] = {};
  size_t l = begin;
  for (; l + 1 < end; l += 2) {
    const float wa = kWeights.weight[link[l] & 255], wb = kWeights.weight[link[l + 1] & 255];
    const float *na = node[link[l] >> 8].v, *nb = node[link[l + 1] >> 8].v;
    for (int k = 0; k < 4; ++k) a[k] += wa * na[k], b[k] += wb * nb[k];
  }
  if (l < end) {
    const float w = kWeights.weight[link[l] & 255];
    for (int k = 0; k < 4; ++k) a[k] += w * node[link[l] >> 8].v[k];
  }
  for (int k = 0; k < 4; ++k) sum[k] += factor * (a[k] + b[k]);
}

}  // namespace

void patchRadiosity(const lw_radiosity_state& state, const Float4* irradiance, Float4* node, uint32_t light) {
  const float reflected = light & LW_RADIOSITY_INDIRECT ? 1.0f : 0.0f, emitted = light & LW_RADIOSITY_EMITTERS ? 1.0f : 0.0f;
  for (size_t i = 0; i < state.radiosity->patches(); ++i)
    for (int k = 0; k < 4; ++k) {
      const float b = reflected * state.albedo[i].v[k] * (state.direct[i].v[k] + state.kept[i].v[k] * irradiance[i].v[k]) + emitted * state.emitted[i].v[k];
      node[i].v[k] = finite(b);
    }
}

void averageNodes(const lw_radiosity& r, Float4* node) {
  for (uint32_t level = 1; level < r.levels; ++level) {
    uint32_t child = r.level_first[level - 1];
    for (uint32_t i = r.level_first[level]; i < r.level_first[level + 1]; ++i) {
      const uint32_t end = std::min(child + kRadiosityBranching, r.level_first[level]);
      Float4 mean{};
      for (; child < end; ++child)
        for (int k = 0; k < 4; ++k) mean.v[k] += r.node_share[child] * node[child].v[k];
      node[i] = mean;
    }
  }
}

void gather(const lw_radiosity_state& state, const Float4* node, Float4* irradiance) {
  const lw_radiosity& r = *state.radiosity;
  const uint32_t* link = r.link.data();
  const LinkRun* run = r.run.data();
  size_t begin = 0;
  for (uint32_t row = 0; row < r.patches(); ++row) {
    float sum[4] = {};
    for (uint32_t i = r.row_first_run[row]; i < r.row_first_run[row + 1]; begin = run[i++].end_link) {
      const float factor = state.gate_set_factor[run[i].gate_set];
      if (factor > 0) addLinks(link, begin, run[i].end_link, node, factor, sum);
    }
    for (int k = 0; k < 4; ++k) irradiance[row].v[k] = finite(sum[k] * r.row_scale[row]);
  }
}

void updateEmitterIrradiance(lw_radiosity_state& state) {
  if (state.emitter_irradiance_valid) return;
  if (state.emits) {
    std::memcpy(state.node.data(), state.emitted.data(), state.emitted.bytes());
    averageNodes(*state.radiosity, state.node.data());
    gather(state, state.node.data(), state.emitter_irradiance.data());
  } else {
    std::memset(state.emitter_irradiance.data(), 0, state.emitter_irradiance.bytes());
  }
  state.emitter_irradiance_valid = true;
}

}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_radiosity_state_create(const lw_radiosity* radiosity, lw_radiosity_state** out) {
  if (!radiosity || !out) return LW_INVALID_ARGUMENT;
  lw_radiosity_state* state = createHandle<lw_radiosity_state>(radiosity->host);
  if (!state) return radiosity->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the radiosity's state");
  state->radiosity = radiosity;
  const size_t patches = radiosity->patches();
  bool enough = state->material.allocate(state->host, radiosity->header.material_count) && state->gate_open.allocate(state->host, radiosity->gates) &&
                state->gate_set_factor.allocate(state->host, radiosity->gate_sets) && state->node.allocate(state->host, radiosity->nodes());
  for (auto* array : {&state->albedo, &state->emitted, &state->direct, &state->kept, &state->irradiance, &state->emitter_irradiance})
    enough = enough && array->allocate(state->host, patches);
  if (!enough) {
    destroyHandle(state);
    return radiosity->host.fail(LW_OUT_OF_MEMORY, "no memory for the state of %zu patches", patches);
  }
  std::memset(state->direct.data(), 0, state->direct.bytes());
  std::memset(state->irradiance.data(), 0, state->irradiance.bytes());
  for (Float4& kept : state->kept) kept = {{1, 1, 1, 1}};
  for (auto& material : state->material) material = LW_RADIOSITY_MATERIAL_INIT;
  for (float& open : state->gate_open) open = 0;
  for (uint32_t m = 0; m < state->material.size(); ++m) applyMaterial(*state, m);
  materialsChanged(*state);
  gatesChanged(*state);
  *out = state;
  return LW_OK;
}

void lw_radiosity_state_destroy(lw_radiosity_state* state) { destroyHandle(state); }

lw_result lw_radiosity_set_material(lw_radiosity_state* state, uint32_t index, const lw_radiosity_material* material) {
  if (!state || !material) return LW_INVALID_ARGUMENT;
  if (index >= state->material.size()) return state->host.fail(LW_NOT_FOUND, "the container has no material %u", index);
  if (!isAmount(material->albedo_factor_rgb, 3) || !isAmount(material->albedo_rgb, 3) || !isAmount(material->emission_factor_rgb, 3) ||
      !isAmount(material->emission_rgb, 3))
    return state->host.fail(LW_INVALID_ARGUMENT, "material %u: a value is negative, too large or not finite", index);
  state->material[index] = *material;
  applyMaterial(*state, index);
  materialsChanged(*state);
  return LW_OK;
}

lw_result lw_radiosity_set_gate(lw_radiosity_state* state, uint32_t gate, float open) {
  if (!state) return LW_INVALID_ARGUMENT;
  if (gate >= state->gate_open.size()) return state->host.fail(LW_NOT_FOUND, "the container has no gate %u", gate);
  if (!(open >= 0 && open <= 1)) return state->host.fail(LW_INVALID_ARGUMENT, "a gate is open by 0 to 1");
  state->gate_open[gate] = open;
  gatesChanged(*state);
  return LW_OK;
}

lw_result lw_radiosity_set_portal(lw_radiosity_state* state, uint32_t index, float open) {
  if (!state) return LW_INVALID_ARGUMENT;
  if (index >= state->radiosity->portal.size()) return state->host.fail(LW_NOT_FOUND, "the container has no portal %u", index);
  if (!(open >= 0 && open <= 1)) return state->host.fail(LW_INVALID_ARGUMENT, "a portal is open by 0 to 1");
  const auto& portal = state->radiosity->portal[index];
  for (uint32_t s = 0; s < portal.strips; ++s) state->gate_open[portal.first_gate + s] = std::clamp(open * float(portal.strips) - float(s), 0.0f, 1.0f);
  gatesChanged(*state);
  return LW_OK;
}

lw_result lw_radiosity_set_direct(lw_radiosity_state* state, const float* irradiance_rgb) {
  if (!state || !irradiance_rgb) return LW_INVALID_ARGUMENT;
  const size_t patches = state->radiosity->patches();
  if (!isAmount(irradiance_rgb, patches * 3)) return state->host.fail(LW_INVALID_ARGUMENT, "an irradiance is negative, too large or not finite");
  for (size_t i = 0; i < patches; ++i) state->direct[i] = {{irradiance_rgb[i * 3], irradiance_rgb[i * 3 + 1], irradiance_rgb[i * 3 + 2], 0}};
  return LW_OK;
}

lw_result lw_radiosity_get_irradiance(lw_radiosity_state* state, uint32_t light, float* irradiance_rgb) {
  if (!state || !irradiance_rgb) return LW_INVALID_ARGUMENT;
  if (light > (LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS | LW_RADIOSITY_LIGHTS)) return state->host.fail(LW_INVALID_ARGUMENT, "no such kind of light");
  if ((light & (LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS)) != (LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS)) updateEmitterIrradiance(*state);
  for (size_t i = 0; i < state->radiosity->patches(); ++i)
    for (int k = 0; k < 3; ++k) {
      const float all = std::max(state->irradiance[i].v[k], 0.0f), emitters = state->emitter_irradiance[i].v[k];
      float value = 0;
      switch (light & (LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS)) {
        case LW_RADIOSITY_INDIRECT: value = std::max(all - emitters, 0.0f); break;
        case LW_RADIOSITY_EMITTERS: value = emitters; break;
        case LW_RADIOSITY_INDIRECT | LW_RADIOSITY_EMITTERS: value = all; break;
      }
      irradiance_rgb[i * 3 + k] = value + (light & LW_RADIOSITY_LIGHTS ? state->direct[i].v[k] : 0.0f);
    }
  return LW_OK;
}
