// Decoding a precomputed radiance map. Everything that evaluation relies on is checked here once.
#include <cfloat>
#include <cstring>

#include "format/decode/pixel.h"
#include "runtime/src/container.h"
#include "runtime/src/prm.h"

namespace lightwell::runtime {
namespace {

using format::ElementType;

/// Decodes the section "prm" chunk by chunk; the first failure stays in `result`.
class Loader {
 public:
  Loader(const lw_container& container, lw_prm& prm) : container_(container), prm_(prm) {}

  lw_result load() {
    if ((result_ = readPrmHeader(container_, prm_.header))) return result_;
    const format::PrmHeader& h = prm_.header;
    if (h.layout == format::PrmLayout::unknown) return container_.host.fail(LW_TOO_NEW, "prm/header: the layout is of a later version");
    if (!h.entries || !h.clusters || h.clusters > h.entries || !h.texels) return bad("header", "its counts cannot be");
    loadAtlas();
    loadEntries();
    if (h.layout == format::PrmLayout::panes) loadPanes();
    else loadLocalBases();
    if (h.has_emitter) {
      decode("emitter_direct", ElementType::rgb9e5, h.texels, prm_.emitter_direct_rgb9e5);
      decode("emitter_indirect", ElementType::rgb9e5, h.texels, prm_.emitter_indirect_rgb9e5);
    }
    if (h.has_sky) {
      if (!(h.sky_scale > 0 && h.sky_scale <= 0x1p60f)) return bad("header", "sky_scale is out of range");
      decode("sky_direct", ElementType::rgb9e5, h.texels, prm_.sky_direct_rgb9e5);
      decode("sky_indirect", ElementType::rgb9e5, h.texels, prm_.sky_indirect_rgb9e5);
    }
    return result_;
  }

 private:
  lw_result bad(const char* chunk, const char* reason) {
    return result_ = container_.host.fail(LW_BAD_SECTION, "prm/%s: %s", chunk, reason);
  }
  void require(bool good, const char* chunk, const char* reason) {
    if (!result_ && !good) bad(chunk, reason);
  }
  template <class T>
  void decode(const char* name, ElementType element, uint64_t elements, Array<T>& values) {
    if (!result_) result_ = decodeChunk(container_, "prm", name, element, elements, values);
  }
  ElementType elementOf(const char* name) {
    const format::ChunkInfo* chunk = result_ ? nullptr : container_.view.findChunk("prm", name);
    if (!chunk) require(false, name, "the chunk is missing");
    return chunk ? chunk->element : ElementType::bytes;
  }
  template <class T>
  bool allocate(Array<T>& values, size_t count) {
    if (result_) return false;
    if (values.allocate(container_.host, count)) return true;
    result_ = container_.host.fail(LW_OUT_OF_MEMORY, "prm: no memory for %zu values", count);
    return false;
  }
  /// Offsets of `count` consecutive ranges that end at `end`.
  static bool areOffsets(const Array<uint32_t>& first, uint32_t end, uint32_t least_length) {
    bool good = first[0] == 0 && first[first.size() - 1] == end;
    for (size_t i = 0; good && i + 1 < first.size(); ++i) good = first[i + 1] >= first[i] && first[i + 1] - first[i] >= least_length;
    return good;
  }

  void loadAtlas() {
    format::AtlasHeader atlas;
    if ((result_ = readAtlasHeader(container_, atlas))) return;
    prm_.width = atlas.width;
    prm_.height = atlas.height;
    const uint64_t texels = uint64_t(atlas.width) * atlas.height;
    if ((result_ = decodeChunk(container_, "atlas", "source", ElementType::u32, texels, prm_.source))) return;
    if (!isSourceMap(prm_.source.data(), texels)) {
      result_ = container_.host.fail(LW_BAD_SECTION, "atlas/source: a texel's source is not its own source");
      return;
    }
    decode("texel", ElementType::u32, prm_.header.texels, prm_.texel);
    Array<uint8_t> taken;
    if (!allocate(taken, texels)) return;
    std::memset(taken.data(), 0, taken.size());
    for (const uint32_t t : prm_.texel) {
      if (t >= texels || taken[t]) return void(bad("texel", "a texel is outside the atlas or occurs twice"));
      taken[t] = 1;
    }
  }

  void loadEntries() {
    const uint64_t entries = prm_.header.entries;
    decode("entry_position", ElementType::f32, entries * 3, prm_.entry_position_m);
    decode("entry_weight", ElementType::f32, entries, prm_.entry_weight);
    decode("cluster_first_entry", ElementType::u32, uint64_t(prm_.header.clusters) + 1, prm_.cluster_first_entry);
    Array<int16_t> oct;
    decode("entry_normal", ElementType::i16, entries * 2, oct);
    if (!allocate(prm_.entry_normal, entries * 3)) return;
    for (size_t i = 0; i < entries; ++i) {
      const format::Float3 n = format::unpackOct({oct[i * 2], oct[i * 2 + 1]});
      std::memcpy(&prm_.entry_normal[i * 3], &n, sizeof n);
    }
    require(allFinite(prm_.entry_position_m.data(), prm_.entry_position_m.size()), "entry_position", "a value is not finite");
    require(allFinite(prm_.entry_weight.data(), entries), "entry_weight", "a value is not finite");
    for (const float w : prm_.entry_weight) require(w >= 0 && w <= 1.001f, "entry_weight", "a weight is outside [0, 1]");
    require(areOffsets(prm_.cluster_first_entry, prm_.header.entries, 1), "cluster_first_entry", "it does not split the entries");
  }

  void loadPanes() {
    const uint64_t texels = prm_.header.texels, clusters = prm_.header.clusters;
    const bool half = elementOf("pane") == ElementType::f16;
    if (half) decode("pane", ElementType::f16, clusters * texels * 3, prm_.pane_half);
    else decode("pane", ElementType::rgb9e5, clusters * texels, prm_.pane_rgb9e5);
    if (!allocate(prm_.pane_sum_rgb, clusters * 3)) return;
    bool finite = true;
    for (const uint16_t v : prm_.pane_half) finite &= (v & 0x7c00u) != 0x7c00u;
    require(finite, "pane", "a value is not finite");
    for (uint64_t c = 0; c < clusters; ++c) {
      double sum[3] = {};
      for (uint64_t i = c * texels; i < (c + 1) * texels; ++i) {
        const format::Float3 v =
            half ? format::Float3{format::unpackHalf(prm_.pane_half[i * 3]), format::unpackHalf(prm_.pane_half[i * 3 + 1]),
                                  format::unpackHalf(prm_.pane_half[i * 3 + 2])}
                 : format::unpackRgb9e5(prm_.pane_rgb9e5[i]);
        sum[0] += v.x;
        sum[1] += v.y;
        sum[2] += v.z;
      }
      for (int k = 0; k < 3; ++k) prm_.pane_sum_rgb[c * 3 + k] = float(sum[k] > 0 ? sum[k] : 0);
    }
  }

  void loadLocalBases() {
    const format::PrmHeader& h = prm_.header;
    if (!result_ && (!h.blocks || h.blocks > h.texels || !h.max_rank || h.max_rank > 255))
      return void(bad("header", "its counts cannot be"));
    decode("block_first_texel", ElementType::u32, uint64_t(h.blocks) + 1, prm_.block_first_texel);
    decode("block_rank", ElementType::u8, h.blocks, prm_.block_rank);
    decode("block_first_link", ElementType::u32, uint64_t(h.blocks) + 1, first_link_);
    if (result_) return;
    if (!areOffsets(prm_.block_first_texel, h.texels, 0)) return void(bad("block_first_texel", "it does not split the texels"));
    const uint32_t links = first_link_[h.blocks];
    if (!areOffsets(first_link_, links, 0)) return void(bad("block_first_link", "it does not split the links"));
    uint64_t basis_size = 0, rank_sum = 0, coefficient_size = 0;
    for (uint32_t b = 0; b < h.blocks; ++b) {
      const uint64_t rank = prm_.block_rank[b];
      require(rank <= h.max_rank, "block_rank", "a rank is above the header's maximum");
      basis_size += rank * (prm_.block_first_texel[b + 1] - prm_.block_first_texel[b]);
      coefficient_size += rank * (first_link_[b + 1] - first_link_[b]) * 3;
      rank_sum += rank;
    }
    decode("basis", ElementType::i8, basis_size, prm_.basis);
    loadLinks(links, rank_sum, coefficient_size);
    loadTree();
    loadRectangles();
  }

  void loadLinks(uint32_t links, uint64_t rank_sum, uint64_t coefficients) {
    Array<uint32_t> wavelet;
    Array<float> scale;
    Array<int8_t> coefficient;
    decode("link_wavelet", ElementType::u32, links, wavelet);
    decode("coefficient_scale", ElementType::f32, rank_sum * 3, scale);
    decode("coefficient", ElementType::i8, coefficients, coefficient);
    if (result_) return;
    const format::PrmHeader& h = prm_.header;
    const uint64_t wavelets = WaveletTree::wavelets(h.clusters);
    for (uint32_t b = 0; b < h.blocks; ++b)
      for (uint32_t l = first_link_[b]; l < first_link_[b + 1]; ++l)
        if (wavelet[l] >= wavelets || (l > first_link_[b] && wavelet[l] < wavelet[l - 1]))
          return void(bad("link_wavelet", "the links of a block do not ascend, or one is no wavelet"));
    if (!allFinite(scale.data(), scale.size())) return void(bad("coefficient_scale", "a value is not finite"));
    const StoredLinks stored{h.blocks, size_t(wavelets), h.max_rank, prm_.block_rank.data(), prm_.block_first_texel.data(), prm_.basis.data(),
                             first_link_.data(), wavelet.data(), scale.data(), coefficient.data()};
    if (!prm_.links.load(container_.host, stored)) result_ = container_.host.fail(LW_OUT_OF_MEMORY, "prm: no memory for %u links", links);
  }

  void loadTree() {
    const uint32_t clusters = prm_.header.clusters;
    Array<uint32_t> first_leaves;
    Array<uint16_t> first_share;
    Array<uint8_t> unit;
    decode("tree_first_leaves", ElementType::u32, clusters - 1, first_leaves);
    decode("tree_first_share", ElementType::u16, clusters - 1, first_share);
    decode("wavelet_unit", ElementType::u8, WaveletTree::wavelets(clusters), unit);
    bool shares_good = true;
    for (const uint16_t share : first_share) shares_good &= share != 0;
    require(shares_good, "tree_first_share", "the share of a first child is zero");
    if (result_) return;
    bool out_of_memory = false;
    if (const char* reason = prm_.tree.load(container_.host, clusters, first_leaves, first_share, unit, out_of_memory)) {
      if (out_of_memory) result_ = container_.host.fail(LW_OUT_OF_MEMORY, "prm: %s", reason);
      else bad("tree_first_leaves", reason);
    }
  }

  void loadRectangles() {
    const uint64_t numbers = uint64_t(prm_.header.entries) * 3;
    Array<uint16_t> half;
    decode("entry_rectangle", ElementType::f16, numbers, half);
    if (!allocate(prm_.entry_rectangle, numbers)) return;
    for (uint64_t i = 0; i < numbers; ++i) prm_.entry_rectangle[i] = format::unpackHalf(half[i]);
    require(allFinite(prm_.entry_rectangle.data(), numbers), "entry_rectangle", "a value is not finite");
  }

  const lw_container& container_;
  lw_prm& prm_;
  Array<uint32_t> first_link_;  // [blocks + 1]
  lw_result result_ = LW_OK;
};

}  // namespace
}  // namespace lightwell::runtime

using namespace lightwell::runtime;

lw_result lw_prm_load(const lw_container* container, lw_prm** out) {
  if (!container || !out) return LW_INVALID_ARGUMENT;
  lw_prm* prm = createHandle<lw_prm>(container->host);
  if (!prm) return container->host.fail(LW_OUT_OF_MEMORY, "no memory for the handle of the radiance maps");
  if (const lw_result result = Loader(*container, *prm).load()) {
    destroyHandle(prm);
    return result;
  }
  *out = prm;
  return LW_OK;
}

void lw_prm_release(lw_prm* prm) {
  if (prm && prm->owners.fetch_sub(1, std::memory_order_acq_rel) == 1) destroyHandle(prm);
}

lw_result lw_prm_get_info(const lw_prm* prm, lw_prm_info* info) {
  if (!prm || !info) return LW_INVALID_ARGUMENT;
  const lightwell::format::PrmHeader& h = prm->header;
  const bool panes = h.layout == lightwell::format::PrmLayout::panes;
  *info = {panes ? LW_PRM_PANES : LW_PRM_LOCAL_BASES, h.entries, h.clusters, h.texels, panes ? 0 : h.blocks, panes ? 0 : h.max_rank,
           panes ? h.brightest : 0, h.has_emitter ? 1u : 0u, h.has_sky ? 1u : 0u, prm->width, prm->height};
  return LW_OK;
}

lw_result lw_prm_get_entries(const lw_prm* prm, lw_prm_entries* entries) {
  if (!prm || !entries) return LW_INVALID_ARGUMENT;
  *entries = {prm->entry_position_m.data(), prm->entry_normal.data(), prm->entry_weight.data(), prm->cluster_first_entry.data()};
  return LW_OK;
}
