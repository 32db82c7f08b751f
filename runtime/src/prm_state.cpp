// Local bases from frame to frame: blocks whose sums have not changed are left as they are in the caller's atlas.
#include "runtime/src/prm_state.h"

#include <algorithm>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/prm_reconstruct.h"
#include "runtime/src/running_sums.h"

namespace lightwell::runtime {

/// A texel of the atlas, and the value that it shows.
struct Shown {
  uint32_t texel, value;
};

}  // namespace lightwell::runtime

struct lw_prm_state {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  ~lw_prm_state() { lw_prm_release(prm); }

  lightwell::runtime::Host host;
  lw_prm* prm = nullptr;              // one of its owners
  lightwell::runtime::RunningSums sums;
  Array<uint32_t> scratch;            // of lw_prm_evaluate, for panes
  Array<uint32_t> first_shown;        // [texels + 1]; of each value, in `shown`
  Array<lightwell::runtime::Shown> shown;  // where gaps are filled, value after value
  const void* atlas = nullptr;        // that shows the sums; null: none does
  lw_prm_options options{};           // it was drawn with
};

namespace lightwell::runtime {
namespace {

/// The atlas's sources the other way round.
bool listShown(const lw_prm& prm, lw_prm_state& state) {
  const size_t texels = prm.texel.size(), atlas = prm.source.size();
  Array<uint32_t> value;  // of a texel of the atlas
  if (!value.allocate(state.host, atlas) || !state.first_shown.allocate(state.host, texels + 1)) return false;
  std::fill_n(value.data(), atlas, kNone);
  for (size_t i = 0; i < texels; ++i) value[prm.texel[i]] = uint32_t(i);
  const auto valueOf = [&](size_t i) { return prm.source[i] != kNone ? value[prm.source[i]] : kNone; };
  std::fill_n(state.first_shown.data(), texels + 1, 0u);
  for (size_t i = 0; i < atlas; ++i)
    if (valueOf(i) != kNone) ++state.first_shown[valueOf(i) + 1];
  for (size_t i = 0; i < texels; ++i) state.first_shown[i + 1] += state.first_shown[i];
  if (!state.shown.allocate(state.host, state.first_shown[texels])) return false;
  for (size_t i = 0; i < atlas; ++i)
    if (const uint32_t v = valueOf(i); v != kNone) state.shown[state.first_shown[v]++] = {uint32_t(i), v};
  for (size_t i = texels; i > 0; --i) state.first_shown[i] = state.first_shown[i - 1];  // each had moved to its end
  state.first_shown[0] = 0;
  return true;
}

/// A texel of the atlas: as values are, or as half floats.
struct Floats {
  float rgba[4];
};
struct Halfs {
  uint16_t rgba[4];
};

void pack(const float* values_rgba, uint32_t count, Floats* texels) { std::memcpy(texels, values_rgba, count * sizeof(Floats)); }

void pack(const float* values_rgba, uint32_t count, Halfs* texels) { packHalfs(values_rgba, count, texels->rgba); }

/// Writes the texels of blocks that have changed; `all`: of all blocks, and nothing elsewhere.
template <class Texel>
lw_prm_changes draw(lw_prm_state& state, const lw_prm_options& options, bool all, Texel* atlas) {
  const lw_prm& prm = *state.prm;
  if (all) std::memset(static_cast<void*>(atlas), 0, prm.source.size() * sizeof(Texel));
  const int8_t* basis = prm.basis.data();
  uint32_t written = 0, least = UINT32_MAX, most = 0;
  const auto write = [&](uint32_t texel, const Texel& value) {
    atlas[texel] = value;
    ++written;
    least = std::min(least, texel);
    most = std::max(most, texel);
  };
  for (uint32_t block = 0; block < prm.header.blocks; ++block) {
    if (!all && !state.sums.touched(prm, block)) {
      basis += size_t(prm.block_rank[block]) * (prm.block_first_texel[block + 1] - prm.block_first_texel[block]);
      continue;
    }
    basis = showBlock(prm, options, block, basis, state.sums.sums(prm, block), [&](uint32_t first, uint32_t end, const float* values_rgba) {
      Texel texels[kTileTexels];
      pack(values_rgba, end - first, texels);
      if (options.fill)
        for (uint32_t i = state.first_shown[first]; i < state.first_shown[end]; ++i) write(state.shown[i].texel, texels[state.shown[i].value - first]);
      else
        for (uint32_t i = first; i < end; ++i) write(prm.texel[i], texels[i - first]);
    });
  }
  if (all) return {uint32_t(prm.source.size()), 0, prm.height};
  return written ? lw_prm_changes{written, least / prm.width, most / prm.width - least / prm.width + 1} : lw_prm_changes{0, 0, 0};
}

template <class Texel>
lw_result update(lw_prm_state& state, const float* cluster_rgb, const lw_prm_options* given, Texel* atlas, lw_prm_changes& changes) {
  const lw_prm& prm = *state.prm;
  lw_prm_options options;
  if (!resolveOptions(given, options)) return prm.host.fail(LW_INVALID_ARGUMENT, "lw_prm_options: a value is out of range");
  if (!isIrradiance(cluster_rgb, size_t(prm.header.clusters) * 3)) return prm.host.fail(LW_INVALID_ARGUMENT, "an irradiance is negative or not finite");
  state.sums.update(prm, cluster_rgb, options.tolerance);
  changes = draw(state, options, state.atlas != atlas || !showTheSame(state.options, options), atlas);
  state.sums.forget(prm);
  state.atlas = atlas;
  state.options = options;
  return LW_OK;
}

}  // namespace

lw_result updateHalfs(lw_prm_state& state, const float* cluster_rgb, const lw_prm_options& options, uint16_t* atlas_rgba, lw_prm_changes& changes) {
  return update(state, cluster_rgb, &options, reinterpret_cast<Halfs*>(atlas_rgba), changes);
}

}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_prm_state_create(const lw_prm* prm, lw_prm_state** out) {
  if (!prm || !out) return LW_INVALID_ARGUMENT;
  lw_prm_state* state = createHandle<lw_prm_state>(prm->host);
  if (!state) return prm->host.fail(LW_OUT_OF_MEMORY, "no memory for a state");
  state->prm = retain(*prm);
  const bool panes = !prm->pane_sum_rgb.empty();
  if (panes ? !state->scratch.allocate(prm->host, lw_prm_scratch_bytes(prm) / sizeof(uint32_t)) : !state->sums.allocate(prm->host, *prm) || !listShown(*prm, *state)) {
    lw_prm_state_release(state);
    return prm->host.fail(LW_OUT_OF_MEMORY, "no memory for a state of %u blocks and %u texels", prm->header.blocks, prm->header.texels);
  }
  *out = state;
  return LW_OK;
}

void lw_prm_state_release(lw_prm_state* state) { destroyHandle(state); }

void lw_prm_state_forget(lw_prm_state* state) {
  if (state) state->atlas = nullptr;
}

lw_result lw_prm_state_update(lw_prm_state* state, const float* cluster_irradiance_rgb, const lw_prm_options* given, float* atlas_rgba, lw_prm_changes* changes) {
  if (!state || !cluster_irradiance_rgb || !atlas_rgba) return LW_INVALID_ARGUMENT;
  const lw_prm& prm = *state->prm;
  lw_prm_changes changed{uint32_t(prm.source.size()), 0, prm.height};
  const lw_result result = state->scratch.empty() ? update(*state, cluster_irradiance_rgb, given, reinterpret_cast<Floats*>(atlas_rgba), changed)
                                                  : lw_prm_evaluate(&prm, cluster_irradiance_rgb, given, state->scratch.data(), state->scratch.size() * sizeof(uint32_t), atlas_rgba);
  if (result == LW_OK && changes) *changes = changed;
  return result;
}
