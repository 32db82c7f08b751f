#include "precompute/transport/many_lights/light_cut.h"

#include <algorithm>

namespace lightwell::transport {

void LightCut::begin(const Receivers& receivers) {
  receivers_ = receivers;
  heap_.clear(), single_.clear();
  if (!tree_.empty()) add(0);
}

void LightCut::add(uint32_t node) {
  const float bound = tree_.bound(node, receivers_);
  if (!(bound > 0)) return;
  if (tree_.firstChild(node) == kNone) {
    single_.push_back(node);
  } else {
    heap_.emplace_back(bound, node);
    std::push_heap(heap_.begin(), heap_.end());
  }
}

void LightCut::refine(double most, size_t most_nodes) {
  while (!heap_.empty() && double(heap_.front().first) > most && heap_.size() + single_.size() < most_nodes) {
    std::pop_heap(heap_.begin(), heap_.end());
    const uint32_t child = tree_.firstChild(heap_.back().second);
    heap_.pop_back();
    add(child), add(child + 1);
  }
}

std::span<const uint32_t> LightCut::nodes() {
  nodes_ = single_;
  for (const auto& [bound, node] : heap_) nodes_.push_back(node);
  return nodes_;
}

}  // namespace lightwell::transport
