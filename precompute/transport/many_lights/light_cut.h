// Many lights at a cost that hardly grows with their number: for each receiver the cut through the tree of lights whose every node can be wrong by little.
// Walter et al., "Lightcuts: A Scalable Approach to Illumination" (SIGGRAPH 2005). A node is seen by a light of it that is picked at random for each point, not by one
// representative for all, so that means have no bias (Yuksel, "Stochastic Lightcuts", HPG 2019).
#pragma once
#include <span>
#include <vector>

#include "precompute/transport/reference/light_tree.h"

namespace lightwell::transport {

/// Keeps its arrays from one receiver to the next.
class LightCut {
 public:
  explicit LightCut(const LightTree& tree) : tree_(tree) {}

  /// Starts from the root. A node that cannot reach the receivers is in no cut.
  void begin(const Receivers& receivers);
  /// Splits the node of largest bound until no node of several lights may give more than `most` (power ÷ length², as LightTree::bound) or
  /// the cut has `most_nodes`.
  void refine(double most, size_t most_nodes);
  /// Nodes of the tree, in an order that depends on nothing else.
  std::span<const uint32_t> nodes();

 private:
  void add(uint32_t node);

  const LightTree& tree_;
  Receivers receivers_;
  std::vector<std::pair<float, uint32_t>> heap_;  // bound and number of nodes with several lights
  std::vector<uint32_t> single_, nodes_;
};

}  // namespace lightwell::transport
