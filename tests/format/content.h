// A small sound container with every section of version 1, as plain data that a test may spoil before it is written.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "format/encode/writer.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {

/// A 4 × 4 atlas (row 0 covered, row 1 gutter, the rest nothing) over two triangles, the second cut-out; three entries in two clusters,
/// and for local bases four in three,
/// with a tree of the first two and the third and a wavelet that a block links twice.
struct Content {
  v1::MetaHeader meta;
  v1::SceneHeader scene;

  std::vector<float> position, lightmap_uv, alpha_uv;
  std::vector<int16_t> normal;
  std::vector<uint32_t> index;
  std::vector<uint8_t> triangle_flags, alpha_texture;
  std::vector<uint16_t> triangle_alpha;
  v1::AlphaMaterials alpha_material;

  v1::AtlasHeader atlas;
  uint32_t atlas_width = 4;  // of the arrays, whatever the header says
  std::vector<uint32_t> source, emission;
  std::vector<uint8_t> coverage, albedo;

  v1::PrmHeader prm;
  std::vector<float> entry_position, entry_weight;
  std::vector<int16_t> entry_normal;
  std::vector<uint32_t> cluster_first_entry, texel;
  std::vector<uint32_t> pane;
  std::vector<uint16_t> pane_half;  // instead of `pane` when not empty
  std::vector<uint16_t> entry_rectangle;  // halfs
  std::vector<uint32_t> tree_first_leaves, block_first_texel, block_first_link, link_wavelet;
  std::vector<uint16_t> tree_first_share;
  std::vector<uint8_t> wavelet_unit, block_rank;
  std::vector<int8_t> basis, coefficient;
  std::vector<float> coefficient_scale;
  std::vector<uint32_t> emitter_direct, emitter_indirect;
  std::vector<uint32_t> sky_direct, sky_indirect;  // not written when empty

  std::set<std::string> left_out;  // "section" or "section/chunk": not written
};

Content panesContent();
Content skyPanesContent();
Content localBasesContent();
Writer toWriter(const Content& content);

}  // namespace lightwell::format
