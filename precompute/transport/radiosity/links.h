// Form factors made small: neighbours merged into nodes, weights of eight bits, rows that keep their sums.
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/transport/radiosity/form_factors.h"

namespace lightwell::transport {

/// What patches receive from nodes of the tree, one row per patch: irradiance(i) = row_scale[i] · Σ_l linkWeight(code[l]) · radiosity(node[l]), where a node's
/// radiosity is the area-weighted mean over its patches.
struct RadiosityLinks {
  std::vector<uint32_t> first = {0};  // rows + 1
  std::vector<uint32_t> node;         // ascending within a row
  std::vector<uint8_t> code;
  std::vector<float> row_scale;       // 0 for empty rows
  uint32_t rows() const { return uint32_t(first.size()) - 1; }
  /// Appends another's rows.
  void append(const RadiosityLinks& other);
};

/// A small float: four bits of exponent, four of mantissa. 16 to 31 << 15.
constexpr uint32_t linkWeight(uint8_t code) { return (16u + (code & 15u)) << (code >> 4); }
/// The code whose weight is nearest, for weights in [16, 31 << 15] (nearest end outside).
uint8_t linkCode(float weight);

struct LinkOptions {
  /// Patches merge into their node where form factors spread over it as its area does, up to this deviation (root of the sum of squares, beyond what
  /// the noise of the rays explains).
  float merge_error = 0.002f;
  /// Links of a row are dropped, the smallest first, while they carry at most this share of its sum; the others take over what they carried.
  float prune_share = 0.005f;
};

/// Compresses the rows [begin, end). `rays` were traced from each patch.
RadiosityLinks makeLinks(const FormFactors& factors, const PatchTree& tree, uint32_t rays, const LinkOptions& options, uint32_t begin, uint32_t end);

}  // namespace lightwell::transport
