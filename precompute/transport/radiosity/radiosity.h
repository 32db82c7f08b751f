// Radiosity with form factors, as data: what the bake makes and the container holds.
//
//   irradiance(patch) = row_scale(patch) · Σ_l linkWeight(code[l]) · radiosity(node[l])
//   radiosity(patch) = albedo · (direct irradiance + irradiance) + π · emitted radiance
// with a node's radiosity the area-weighted mean over its patches. Albedo, emission and direct light are the game's to change.
#pragma once
#include "precompute/transport/radiosity/links.h"
#include "precompute/transport/radiosity/texel_weights.h"

namespace lightwell::transport {

struct RadiosityResult {
  Patches patches;
  PatchTree tree;
  RadiosityLinks links;
  std::vector<uint32_t> texel;                      // atlas texel of each value, ascending
  std::vector<std::array<uint32_t, 4>> texel_patch; // TexelWeights, per value
  std::vector<std::array<float, 4>> texel_weight;
  std::vector<float> texel_exposed;                 // share of the texel's surface in the open
  std::vector<uint32_t> texel_back_patch;           // of the backs of double-sided texels, else kNone; empty where there are none
  uint64_t raw_transfers = 0;                       // pairs of patches that exchange light, before compression
  uint32_t dark_patches = 0;                        // whose links were left out: in sealed rooms without light
};

}  // namespace lightwell::transport
