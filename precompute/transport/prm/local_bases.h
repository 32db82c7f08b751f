// Local bases: blocks of texels, each with a few basis maps of its own and coefficients over the clusters that matter to it.
//
// Light is local, so a basis common to a whole level fails while one per block of texels needs few maps (measured in docs/design/).
// The basis of a block is that of principal components of the block's indirect light under lights drawn from the prior; coefficients
// are the projection of the block's transport on it. Clusters whose detail a block cannot see are replaced by their group.
#pragma once
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/prm/multi_bounce.h"
#include "precompute/transport/prm/partition.h"

namespace lightwell::transport {

struct LocalBasesOptions {
  uint32_t block_texels = 48;      // aimed at
  uint32_t most_rank = 16;         // 1 … 64
  float rank_error = 0.015f;       // a block's rank is the least that leaves this relative residual under the training lights
  float link_error = 0.03f;        // clusters merge into groups up to this relative error under the training lights
  float prune_error = 0.05f;       // groups whose light hardly arrives are left out up to this relative error; groups lit alike carry their light
  uint32_t rays = 1024;            // gathered per texel
};

/// Direct irradiance of the training lights, and what it becomes after all further bounces; computed once, read by every block.
/// Groups that are lit much as another is: where the other is left out, one of these carries its light.
struct StandIns {
  static constexpr uint32_t kMost = 32;
  std::vector<uint32_t> group;  // [group][kMost], the most alike first; kNone where there are fewer
};

struct TrainingLights {
  uint32_t count = 0;
  // [cluster][light]: direct irradiance on fine clusters and groups (PrmEntries order); grey lights, so one channel.
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> direct;
  ChannelMatrices cluster_indirect;  // [fine cluster][light]: indirect irradiance on fine clusters
  std::vector<float> weight;       // per light: one over its mean indirect irradiance over the groups' area; 0 for sealed pockets
  StandIns stand_ins;
};

TrainingLights makeTrainingLights(const EntryClusters& clusters, const MultiBounce& multi_bounce,
                                  std::vector<std::vector<float>> direct_irradiance);

/// What the scene's own emitters give: direct irradiance on clusters and groups (PrmEntries order) and, after further bounces, on fine clusters.
struct EmitterLight {
  std::vector<Rgb> direct_rgb, cluster_indirect_rgb;  // both empty without emitters
};

/// One block's share of PrmLocalBases.
struct BasisBlock {
  std::vector<uint32_t> slot;      // the block's texels
  uint32_t rank = 0;
  std::vector<float> basis;        // [texel][rank], multiples of 1/127 in [−1, 1]
  std::vector<uint32_t> link_cluster;
  std::vector<float> coefficient;  // [link][rank][3]
  std::vector<Rgb> emitter_indirect_rgb;  // [texel]; empty without emitters
};

/// Traces the block's texels and fits its basis. `slot_area` are their areas. Depends on nothing but its arguments.
BasisBlock fitBlock(std::span<const uint32_t> slots, const Gatherer& gatherer, const EntryClusters& clusters, const MultiBounce& multi_bounce,
                    const TrainingLights& training, const EmitterLight& emitters, std::span<const float> slot_area, const LocalBasesOptions& options);

}  // namespace lightwell::transport
