// Entry points: where moving lights feed the precomputed transport. Clusters of them by position and normal, at two scales.
#pragma once
#include "precompute/transport/prm/partition.h"
#include "precompute/transport/prm/prm.h"
#include "precompute/transport/prm/sides.h"

namespace lightwell::transport {

struct EntryOptions {
  uint32_t clusters = 8192;          // aimed at; the near field of direct light
  uint32_t groups = 1024;            // aimed at; what has been reflected once more is smooth
  uint32_t points_per_cluster = 4;
  uint32_t points_per_group = 8;
};

/// A partition of the lit sides into fine clusters, each inside one coarse group, with entry points for both.
/// In PrmEntries the fine clusters come first, then the groups (as clusters of their own, number cluster_count + group).
struct EntryClusters {
  uint32_t cluster_count = 0, group_count = 0;
  std::vector<uint32_t> cluster_of_side;  // kNone for mostly buried texels: what little of them is seen counts as dark
  std::vector<uint32_t> group_of_cluster;
  std::vector<float> area;                // cluster_count + group_count, internal units²
  std::vector<uint32_t> cluster_first_side, cluster_side;  // the sides of each fine cluster
  std::vector<uint32_t> group_first_cluster;               // the fine clusters of each group are consecutive
  PrmEntries entries;
};

EntryClusters makeEntries(const atlas::Atlas& atlas, const Sides& sides, const EntryOptions& options);

}  // namespace lightwell::transport
