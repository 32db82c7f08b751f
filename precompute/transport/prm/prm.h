// Precomputed radiance maps (Szécsi, Szirmay-Kalos: "On Making Light Maps Dynamic"), as data: what the bake makes and the container holds.
//
// Direct irradiance at clusters of entry points, times a transport matrix, is indirect irradiance at the texels:
//   irradiance(texel) = Σ_cluster transport(texel, cluster) * irradiance(cluster)          per colour channel,
// where irradiance(cluster) is the weighted mean over the cluster's entry points. Albedo at the entry is inside the transport.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "precompute/core/math.h"
#include "precompute/transport/prm/wavelets.h"

namespace lightwell::transport {

/// Entry points sorted by cluster.
struct PrmEntries {
  std::vector<Vec3> position;    // internal units, on the surface
  std::vector<Vec3> normal;      // unit, on the side that is lit
  // Half the sides of the rectangle that stands for the surface around the point: perpendicular to each other and to the normal. A light close by is
  // averaged over it; from afar it is a point.
  std::vector<Vec3> half_u, half_v;
  std::vector<float> weight;     // within the cluster; each cluster's sum is 1
  std::vector<uint32_t> cluster_first_entry;  // clusters + 1
  uint32_t clusterCount() const { return uint32_t(cluster_first_entry.size()) - 1; }
};

/// The paper's form: one pane of irradiance per cluster.
struct PrmPanes {
  std::vector<Rgb> irradiance_rgb;  // [cluster][texel], for unit irradiance at the cluster
};

/// Blocks of values with their own basis maps, whose amounts come from the wavelets of direct light that matter to the block:
///   value(i, channel) = Σ_k basis(i, k) · scale(block, k, channel) · Σ_l coefficient(l, k, channel) · wavelet(link_wavelet[l], channel) / unit(link_wavelet[l])
struct PrmBlocks {
  std::vector<uint8_t> block_rank;          // blocks
  std::vector<int8_t> basis;                // per block: [value][rank]; in 1/127
  std::vector<float> scale;                 // per block: [rank][3]
  std::vector<uint32_t> block_first_link = {0};  // blocks + 1, into link_wavelet
  std::vector<uint32_t> link_wavelet;       // ascending within a block; one that needs more than a byte is linked several times
  std::vector<int8_t> coefficient;          // per block: [link][rank][3]
};

/// Blocks of texels, whose values are irradiance.
struct PrmLocalBases : PrmBlocks {
  WaveletTree tree;                         // over the clusters of the entries
  std::vector<uint8_t> wavelet_unit;        // waveletCount(clusters); codes of waveletUnit()
  std::vector<uint32_t> block_first_texel = {0};  // blocks + 1, into PrmResult::texel
};

/// A block for each point in the air: probe_basis.h says what its twelve values are.
struct PrmProbes : PrmBlocks {
  std::vector<Vec3> position;                            // internal units
  std::vector<std::array<Rgb, 9>> emitter_radiance_sh;   // empty without emitters
};

struct PrmResult {
  PrmEntries entries;
  std::vector<uint32_t> texel;  // atlas texel of each value; for local bases grouped by block
  PrmPanes panes;               // empty unless this is the layout
  PrmLocalBases bases;          // empty unless this is the layout
  PrmProbes probes;             // empty unless points were given; with local bases only
  std::vector<Rgb> emitter_direct_rgb, emitter_indirect_rgb;  // per texel; empty without emitters
};

}  // namespace lightwell::transport
