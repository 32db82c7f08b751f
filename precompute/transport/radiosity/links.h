// Form factors made small: neighbours merged into nodes, weights of eight bits, rows that keep their sums.
#pragma once
#include <cstdint>
#include <vector>

#include "precompute/transport/radiosity/training.h"

namespace lightwell::transport {

/// What patches receive from nodes of the tree, one row per patch: irradiance(i) = row_scale[i] · Σ_l linkWeight(code[l]) · radiosity(node[l]), where a node's
/// radiosity is the area-weighted mean over its patches, and l runs over the links whose gates are as their set says.
struct RadiosityLinks {
  std::vector<uint32_t> first = {0};  // rows + 1
  std::vector<uint32_t> node;         // ascending within a row and set
  std::vector<uint32_t> set;          // of gates, ascending within a row; empty without portals
  std::vector<uint8_t> code;
  std::vector<float> row_scale;       // 0 for empty rows
  GateSets sets;
  uint32_t rows() const { return uint32_t(first.size()) - 1; }
};

/// The same before it is rounded: irradiance(i) = Σ_l value[l] · radiosity(node[l]).
struct LinkValues {
  std::vector<uint32_t> first = {0};
  std::vector<uint32_t> node;  // ascending within a row and set
  std::vector<uint32_t> set;   // of gates, ascending within a row; empty without portals
  std::vector<float> value;    // > 0
  GateSets sets;
  uint32_t rows() const { return uint32_t(first.size()) - 1; }
  /// Appends another's rows, of the same sets.
  void append(const LinkValues& other);
};

/// A small float: four bits of exponent, four of mantissa. 16 to 31 << 15.
constexpr uint32_t linkWeight(uint8_t code) { return (16u + (code & 15u)) << (code >> 4); }
/// The code whose weight is nearest, for weights in [16, 31 << 15] (nearest end outside).
uint8_t linkCode(float weight);

struct LinkOptions {
  /// Neighbours merge into their node, and small links are dropped, up to this relative error of the row's irradiance (rms over the training lights, each
  /// relative to the row's irradiance and a tenth of the scene's mean).
  float link_error = 0.025f;
  /// And only where form factors spread over the node as its area does, up to this deviation (root of the sum of squares over its patches, beyond what the noise
  /// of the rays explains): right for lights that nobody trained on.
  float uneven = 0.001f;
  float prune = 0.002f;  // share of a row's sum that dropped links may have carried; the others take over
  uint32_t rays = 1024;  // that were traced from each patch
};

/// Per node whether its patches see the same surroundings with all portals shut, and depend on the same gate themselves. Nodes that do not, because they lie on both sides of a wall or a
/// leaf, merge for nobody: light that no training light showed could leak through them.
std::vector<char> nodesThatSeeTheSame(const FormFactors& factors, const PatchTree& tree);

/// Compresses the rows [begin, end) of `factors`, under at least one training light.
LinkValues makeLinks(const FormFactors& factors, const PatchTree& tree, const RadiosityTraining& training, const LinkOptions& options, uint32_t begin,
                         uint32_t end);

/// Merged links spread what comes from a node evenly over it, so that some patches seem to send more than they have and others less. Scales links until all
/// patches together receive from each what it sends (to whom it sends is symmetric: Σ_i A_i F_ij = A_j Σ_i F_ji), while rows keep their sums; each with all portals shut, and with all open.
void balanceLinks(const PortalZones& zones, const Patches& patches, const PatchTree& tree, LinkValues& links);

/// Rounds to eight bits a weight; rows keep their sums, and with portals the sum of each set as nearly as its smallest weight allows.
RadiosityLinks quantiseLinks(const LinkValues& links);

}  // namespace lightwell::transport
