// A decoded precomputed radiance map. The arrays keep the types of the container; docs/format.md gives their meaning.
#pragma once
#include <atomic>
#include <cstring>

#include "format/decode/headers.h"
#include "runtime/src/host.h"
#include "runtime/src/prm_links.h"
#include "runtime/src/wavelets.h"

struct lw_prm {
  template <class T>
  using Array = lightwell::runtime::Array<T>;

  lightwell::runtime::Host host;
  std::atomic<uint32_t> owners = 1;     // handles that need it: the caller's, and those on OpenGL
  lightwell::format::PrmHeader header;
  uint32_t width = 0, height = 0;       // of the atlas
  Array<uint32_t> source;               // [height * width]; each texel's source is its own source, or none
  Array<uint32_t> texel;                // [texels]; unique

  Array<float> entry_position_m;        // [entries][3]
  Array<float> entry_normal;            // [entries][3]
  Array<float> entry_weight;            // [entries]
  Array<float> entry_rectangle;         // [entries][3]: half the sides in metres, the turn in half turns; or empty: points
  Array<uint32_t> cluster_first_entry;  // [clusters + 1]

  // Panes: one of the two is filled.
  Array<uint32_t> pane_rgb9e5;          // [clusters][texels]
  Array<uint16_t> pane_half;            // [clusters][texels][3]
  Array<float> pane_sum_rgb;            // [clusters][3]: over the texels, what ranks clusters and keeps their energy

  // Local bases.
  Array<uint32_t> block_first_texel;    // [blocks + 1]
  Array<uint8_t> block_rank;            // [blocks]
  Array<int8_t> basis;                  // per block [texel][rank], value / 127
  lightwell::runtime::PrmLinks links;   // from wavelets to blocks
  lightwell::runtime::WaveletTree tree; // over the clusters

  Array<uint32_t> emitter_direct_rgb9e5, emitter_indirect_rgb9e5;  // [texels], or empty
  Array<uint32_t> sky_direct_rgb9e5, sky_indirect_rgb9e5;          // [texels], times header.sky_scale; or empty
};

namespace lightwell::runtime {

/// A local basis's number as GL reads GL_BYTE normalised: −128 is −1 too.
inline float basisValue(int8_t v) { return v < -127 ? -1.0f : float(v) * (1.0f / 127.0f); }

/// Makes one more owner; lw_prm_release ends one.
inline lw_prm* retain(const lw_prm& prm) {
  auto& owned = const_cast<lw_prm&>(prm);
  owned.owners.fetch_add(1, std::memory_order_relaxed);
  return &owned;
}

/// Memory of the sums over the links, parts of one piece of scratch.
struct SumMemory {
  SumMemory(const lw_prm& prm, float* scratch)
      : wavelet_rgb(scratch), power(scratch + prm.tree.wavelets() * 3), cost(power + prm.tree.wavelets()), chosen(reinterpret_cast<uint32_t*>(cost + prm.tree.wavelets())),
        applied_rgb(scratch + prm.tree.wavelets() * 6), sums(applied_rgb + prm.tree.wavelets() * 3),
        touched(reinterpret_cast<uint8_t*>(sums + prm.links.blocks() * prm.links.stride())) {}
  static size_t floats(const lw_prm& prm) { return prm.tree.wavelets() * 9 + prm.links.blocks() * prm.links.stride() + (pieces(prm) + 3) / 4; }
  static size_t pieces(const lw_prm& prm) { return prm.links.blocks() * (prm.links.stride() / 8); }
  /// Dark: where every update has to start once.
  void clear(const lw_prm& prm) { std::memset(applied_rgb, 0, (floats(prm) - prm.tree.wavelets() * 6) * sizeof(float)); }
  LinkChange change() const { return {wavelet_rgb, applied_rgb, sums, touched, power, cost, chosen}; }

  float* wavelet_rgb;          // [wavelets][3]: the light to sum
  float *power, *cost;         // [wavelets], of an update
  uint32_t* chosen;            // [wavelets], of an update
  float* applied_rgb;          // [wavelets][3]: what `sums` stand for
  float* sums;                 // [blocks][stride]; irradiance = Σ_k basisValue(basis[k]) sums[k] scale[k]
  uint8_t* touched;            // [blocks][stride / 8]: 1 where sums have changed
};

/// Luminance of a cluster's contribution to the atlas, by which the brightest are chosen. `pane_sum_rgb` is null for local bases.
inline float contribution(const float* irradiance_rgb, const float* pane_sum_rgb) {
  return pane_sum_rgb ? 0.2126f * (irradiance_rgb[0] * pane_sum_rgb[0]) + 0.7152f * (irradiance_rgb[1] * pane_sum_rgb[1]) +
                            0.0722f * (irradiance_rgb[2] * pane_sum_rgb[2])
                      : 0.0f;
}

/// Finite and not negative.
bool isIrradiance(const float* values, size_t count);

/// Whether texels whose sums are equal look the same with both options.
inline bool showTheSame(const lw_prm_options& a, const lw_prm_options& b) {
  return a.emitters == b.emitters && a.fill == b.fill && std::memcmp(a.sky_rgb, b.sky_rgb, sizeof a.sky_rgb) == 0;
}

/// Options with their defaults; false when they are not valid.
bool resolveOptions(const lw_prm_options* given, lw_prm_options& options);

}  // namespace lightwell::runtime
