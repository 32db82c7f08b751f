// Entry points: where moving lights feed the precomputed transport. Clusters of them by position and normal, at two scales.
#pragma once
#include <span>

#include "precompute/core/bytes.h"
#include "precompute/core/diagnostics.h"
#include "precompute/trace/tracer.h"
#include "precompute/transport/prm/light_prior.h"
#include "precompute/transport/prm/partition.h"
#include "precompute/transport/prm/prm.h"
#include "precompute/transport/sides.h"

namespace lightwell::transport {

struct EntryOptions {
  uint32_t clusters = 20000;         // aimed at; the near field of direct light. No smaller than texels
  uint32_t groups = 1280;            // aimed at; what has been reflected once more is smooth
  uint32_t points_per_cluster = 1;
  uint32_t points_per_group = 8;     // panes only
  bool denser_where_near = true;     // smaller clusters and groups where surfaces see others close by
  bool split_by_visibility = true;   // cut groups that lie on both sides of a wall; adds some
};

/// A partition of the lit sides into fine clusters, each inside one coarse group, with entry points for both.
/// In PrmEntries the fine clusters come first, then the groups (as clusters of their own, number cluster_count + group).
struct EntryClusters {
  uint32_t cluster_count = 0, group_count = 0;
  std::vector<uint32_t> cluster_of_side;  // kNone for buried texels
  std::vector<uint32_t> group_of_cluster;
  std::vector<float> area;                // cluster_count + group_count, internal units²: of what is exposed
  std::vector<float> exposed;             // per side, the share of its area
  WaveletTree tree;                       // over the fine clusters; each group is the clusters under one node, or one cluster
  std::vector<uint32_t> cluster_first_side, cluster_side;  // the sides of each fine cluster
  std::vector<uint32_t> group_first_cluster;               // the fine clusters of each group are consecutive
  PrmEntries entries;
  uint32_t merged_clusters = 0;           // that there would be if light reached them

  std::span<const uint32_t> sidesOf(uint32_t cluster) const { return sidesBetween(cluster, cluster + 1); }
  std::span<const uint32_t> sidesOfGroup(uint32_t group) const { return sidesBetween(group_first_cluster[group], group_first_cluster[group + 1]); }

 private:
  std::span<const uint32_t> sidesBetween(uint32_t first_cluster, uint32_t end_cluster) const {
    return std::span<const uint32_t>(cluster_side).subspan(cluster_first_side[first_cluster],
                                                           cluster_first_side[end_cluster] - cluster_first_side[first_cluster]);
  }
};

/// `likely_lights`: fine clusters that are neighbours and that none of them reaches are one; none: all stay. `threads`: 0 for all of the machine; the result does not depend on it.
/// Throws Cancelled; `cancel` may be null.
EntryClusters makeEntries(const scene::Scene& scene, const atlas::Atlas& atlas, const trace::Tracer& tracer, const EntryOptions& options,
                          std::span<const PriorLight> likely_lights, uint64_t seed, int threads = 0, const CancelFlag* cancel = nullptr);

/// As a task's result. readEntries throws std::runtime_error for bytes that are too short.
Bytes toBytes(const EntryClusters& clusters);
EntryClusters readEntries(ByteView bytes);

}  // namespace lightwell::transport
