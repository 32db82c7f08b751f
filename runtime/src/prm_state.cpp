// Local bases from frame to frame: blocks whose sums have not changed are left as they are in the caller's atlas.
#include "lightwell/lightwell_prm_state.h"

#include <algorithm>
#include <cstring>

#include "runtime/src/container.h"
#include "runtime/src/prm_reconstruct.h"
#include "runtime/src/running_sums.h"

struct lw_prm_state {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  ~lw_prm_state() { lw_prm_release(prm); }

  lightwell::runtime::Host host;
  lw_prm* prm = nullptr;              // one of its owners
  lightwell::runtime::RunningSums sums;
  Array<uint32_t> scratch;            // of lw_prm_evaluate, for panes
  Array<uint32_t> first_copy, copy;   // [texels + 1]; of each value, the texels of the atlas that show it besides its own
  const float* atlas_rgba = nullptr;  // that shows the sums; null: none does
  lw_prm_options options{};           // it was drawn with
};

namespace lightwell::runtime {
namespace {

/// The atlas's sources the other way round.
bool listCopies(const lw_prm& prm, lw_prm_state& state) {
  const size_t texels = prm.texel.size(), atlas = prm.source.size();
  Array<uint32_t> value;  // of a texel of the atlas
  if (!value.allocate(state.host, atlas) || !state.first_copy.allocate(state.host, texels + 1)) return false;
  std::fill_n(value.data(), atlas, kNone);
  for (size_t i = 0; i < texels; ++i) value[prm.texel[i]] = uint32_t(i);
  const auto shown = [&](size_t i) { return prm.source[i] != kNone && prm.source[i] != i ? value[prm.source[i]] : kNone; };
  std::fill_n(state.first_copy.data(), texels + 1, 0u);
  for (size_t i = 0; i < atlas; ++i)
    if (shown(i) != kNone) ++state.first_copy[shown(i) + 1];
  for (size_t i = 0; i < texels; ++i) state.first_copy[i + 1] += state.first_copy[i];
  if (!state.copy.allocate(state.host, state.first_copy[texels])) return false;
  for (size_t i = 0; i < atlas; ++i)
    if (shown(i) != kNone) state.copy[state.first_copy[shown(i)]++] = uint32_t(i);
  for (size_t i = texels; i > 0; --i) state.first_copy[i] = state.first_copy[i - 1];  // each had moved to its end
  state.first_copy[0] = 0;
  return true;
}

/// What was written, in rows.
class Written {
 public:
  explicit Written(uint32_t width) : width_(width) {}
  void add(size_t texel) {
    const uint32_t row = uint32_t(texel / width_);
    first_ = std::min(first_, row);
    end_ = std::max(end_, row + 1);
    ++texels_;
  }
  lw_prm_changes changes() const { return texels_ ? lw_prm_changes{texels_, first_, end_ - first_} : lw_prm_changes{0, 0, 0}; }

 private:
  uint32_t width_, texels_ = 0, first_ = UINT32_MAX, end_ = 0;
};

/// What is filled with a value of a block that was written: texels that show it, and those of the block that show another one's value, as buried ones do.
void fillAround(const lw_prm_state& state, uint32_t value, float* atlas_rgba, Written& written) {
  const lw_prm& prm = *state.prm;
  const uint32_t own = prm.texel[value], source = prm.source[own];
  const auto copy = [&](size_t to, size_t from) { std::memcpy(atlas_rgba + to * 4, atlas_rgba + from * 4, 4 * sizeof(float)); };
  if (source == own) written.add(own);
  else if (source == kNone) std::memset(atlas_rgba + size_t(own) * 4, 0, 4 * sizeof(float));
  else copy(own, source);
  for (uint32_t c = state.first_copy[value]; c < state.first_copy[value + 1]; ++c) {
    copy(state.copy[c], own);
    written.add(state.copy[c]);
  }
}

/// Writes the texels of blocks that have changed.
lw_prm_changes drawTouched(lw_prm_state& state, const lw_prm_options& options, float* atlas_rgba) {
  const lw_prm& prm = *state.prm;
  const int8_t* basis = prm.basis.data();
  for (uint32_t block = 0; block < prm.header.blocks; ++block) {
    const uint32_t first = prm.block_first_texel[block], end = prm.block_first_texel[block + 1];
    if (!state.sums.touched(prm, block)) {
      basis += size_t(prm.block_rank[block]) * (end - first);
      continue;
    }
    basis = reconstructBlock(prm, block, basis, state.sums.sums(prm, block), atlas_rgba);
    addConstants(prm, options, first, end, atlas_rgba);
  }
  Written written(prm.width);
  for (uint32_t block = 0; block < prm.header.blocks; ++block) {
    if (!state.sums.touched(prm, block)) continue;
    for (uint32_t i = prm.block_first_texel[block]; i < prm.block_first_texel[block + 1]; ++i) {
      if (options.fill) fillAround(state, i, atlas_rgba, written);
      else written.add(prm.texel[i]);
    }
  }
  return written.changes();
}

lw_prm_changes drawAll(lw_prm_state& state, const lw_prm_options& options, float* atlas_rgba) {
  const lw_prm& prm = *state.prm;
  std::memset(atlas_rgba, 0, prm.source.size() * 4 * sizeof(float));
  const int8_t* basis = prm.basis.data();
  for (uint32_t block = 0; block < prm.header.blocks; ++block) basis = reconstructBlock(prm, block, basis, state.sums.sums(prm, block), atlas_rgba);
  addConstants(prm, options, 0, prm.header.texels, atlas_rgba);
  if (options.fill) fillFromSources(prm.source.data(), prm.source.size(), atlas_rgba);
  return {uint32_t(prm.source.size()), 0, prm.height};
}

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_prm_state_create(const lw_prm* prm, lw_prm_state** out) {
  if (!prm || !out) return LW_INVALID_ARGUMENT;
  lw_prm_state* state = createHandle<lw_prm_state>(prm->host);
  if (!state) return prm->host.fail(LW_OUT_OF_MEMORY, "no memory for a state");
  state->prm = retain(*prm);
  const bool panes = !prm->pane_sum_rgb.empty();
  if (panes ? !state->scratch.allocate(prm->host, lw_prm_scratch_bytes(prm) / sizeof(uint32_t)) : !state->sums.allocate(prm->host, *prm) || !listCopies(*prm, *state)) {
    lw_prm_state_release(state);
    return prm->host.fail(LW_OUT_OF_MEMORY, "no memory for a state of %u blocks and %u texels", prm->header.blocks, prm->header.texels);
  }
  *out = state;
  return LW_OK;
}

void lw_prm_state_release(lw_prm_state* state) { destroyHandle(state); }

void lw_prm_state_forget(lw_prm_state* state) {
  if (state) state->atlas_rgba = nullptr;
}

lw_result lw_prm_state_update(lw_prm_state* state, const float* cluster_irradiance_rgb, const lw_prm_options* given, float* atlas_rgba, lw_prm_changes* changes) {
  if (!state || !cluster_irradiance_rgb || !atlas_rgba) return LW_INVALID_ARGUMENT;
  const lw_prm& prm = *state->prm;
  lw_prm_changes changed{uint32_t(prm.source.size()), 0, prm.height};
  if (!state->scratch.empty()) {
    const lw_result result = lw_prm_evaluate(&prm, cluster_irradiance_rgb, given, state->scratch.data(), state->scratch.size() * sizeof(uint32_t), atlas_rgba);
    if (result != LW_OK) return result;
  } else {
    lw_prm_options options;
    if (!resolveOptions(given, options)) return prm.host.fail(LW_INVALID_ARGUMENT, "lw_prm_options: a value is out of range");
    if (!isIrradiance(cluster_irradiance_rgb, size_t(prm.header.clusters) * 3)) return prm.host.fail(LW_INVALID_ARGUMENT, "an irradiance is negative or not finite");
    state->sums.update(prm, cluster_irradiance_rgb, options.tolerance);
    changed = state->atlas_rgba == atlas_rgba && showTheSame(state->options, options) ? drawTouched(*state, options, atlas_rgba) : drawAll(*state, options, atlas_rgba);
    state->sums.forget(prm);
    state->atlas_rgba = atlas_rgba;
    state->options = options;
  }
  if (changes) *changes = changed;
  return LW_OK;
}
