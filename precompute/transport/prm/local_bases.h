// Local bases: blocks of texels, each with a few basis maps of its own, whose amounts come from the wavelets of direct light that matter to the block.
//
// Light is local, so a basis common to a whole level fails while one per block of texels needs few maps (measured in docs/design/). The basis of a block
// is that of principal components of the block's indirect light under lights drawn from the prior; the amounts are the projection of the block's transport on
// it, as a sparse row over the wavelets, quantised in steps that are even in what they change under those lights.
#pragma once
#include "precompute/transport/prm/block_transport.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/prm/multi_bounce.h"
#include "precompute/transport/prm/partition.h"
#include "precompute/transport/prm/response_tree.h"

namespace lightwell::transport {

struct LocalBasesOptions {
  uint32_t block_texels = 48;      // aimed at; blocks are halved where their rank does not do
  uint32_t least_texels = 8;       // blocks of fewer than twice as many are not
  uint32_t most_rank = 8;          // 1 … 64
  float rank_error = 0.055f;        // a block's rank is the least that leaves this relative residual under the training lights, noise apart
  float wavelet_step = 0.0125f;    // of a coefficient: what it changes of the block's light, relative to that light, under usual lights; finer for the first map
  uint32_t rays = 2560;            // gathered per texel
};

/// The lights that bases are fitted to, with all their bounces; computed once, read by every block. Each light is of one colour channel, a third of them of
/// each; in a scene of greys one stands for all.
struct TrainingLights {
  uint32_t count = 0;
  bool grey = false;
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> total;  // [fine cluster][light]: irradiance, direct and indirect
  std::vector<float> weight;          // per light: one over its mean indirect irradiance over the clusters' area; 0 for sealed pockets
  std::vector<uint8_t> wavelet_unit;  // [wavelet]: codes of waveletUnit(): the rms over the lights of the wavelet times the light's weight, in `mean_unit`
  float mean_unit = 1;                // the same of the mean over everything
  Rgb channel_gain{1, 1, 1};          // rms weight of a channel's lights over that of all: a dark channel needs finer steps

  /// The lights of a channel: [first(channel), first(channel + 1)).
  uint32_t first(int channel) const { return grey ? (channel > 1 ? count : 0) : uint32_t(uint64_t(count) * uint32_t(channel) / 3); }
};

/// `direct_irradiance`: per light, on fine clusters.
TrainingLights makeTrainingLights(const EntryClusters& clusters, const WaveletIndex& wavelets, const MultiBounce& multi_bounce, bool grey,
                                  const std::vector<std::vector<float>>& direct_irradiance);

/// What the scene's own emitters give: irradiance on fine clusters, direct and after further bounces.
struct EmitterLight {
  std::vector<Rgb> cluster_rgb;  // empty without emitters
};

/// One block's share of PrmLocalBases.
struct BasisBlock {
  std::vector<uint32_t> slot;      // the block's texels
  uint32_t rank = 0;
  std::vector<int8_t> basis;       // [texel][rank], in 1/127
  std::vector<float> scale;        // [rank][3]
  std::vector<uint32_t> link_wavelet;
  std::vector<int8_t> coefficient; // [link][rank][3]
  std::vector<Rgb> emitter_indirect_rgb;  // [texel]; empty without emitters
};

/// Fits one basis of at most options.most_rank maps to all rows of each of `transports`; `weight`: of a row in the sum that is kept (the area of a texel).
std::vector<BasisBlock> fitWhole(std::span<const BlockTransport> transports, const std::vector<float>& weight, const EntryClusters& clusters, const WaveletIndex& wavelets,
                                 const MultiBounce& multi_bounce, const TrainingLights& training, const LocalBasesOptions& options);

/// Traces the texels of some blocks, `slots` of each, and fits their bases: of one block or, where more of their light stands out of the estimate's noise than most_rank maps can hold, of
/// several; one list for each. Depends on nothing but its arguments.
std::vector<std::vector<BasisBlock>> fitBlocks(std::span<const std::vector<uint32_t>> slots, const atlas::Atlas& atlas, const Gatherer& gatherer, const EntryClusters& clusters,
                                               const WaveletIndex& wavelets, const MultiBounce& multi_bounce, const TrainingLights& training,
                                               const EmitterLight& emitters, const LocalBasesOptions& options);

}  // namespace lightwell::transport
