#include "precompute/transport/radiosity/gate_sets.h"

#include <algorithm>

namespace lightwell::transport {

uint32_t GateSets::number(std::span<const GateEntry> entries) {
  if (entries.empty()) return 0;
  std::vector<GateEntry> sorted(entries.begin(), entries.end());
  std::sort(sorted.begin(), sorted.end());
  const auto [found, is_new] = number_.try_emplace(std::move(sorted), count());
  if (is_new) {
    entry_.insert(entry_.end(), found->first.begin(), found->first.end());
    first_.push_back(uint32_t(entry_.size()));
  }
  return found->second;
}

GateClass GateSets::classOf(uint32_t set) const {
  bool closed = false, open = false;
  for (const GateEntry entry : (*this)[set]) (isClosed(entry) ? closed : open) = true;
  return closed ? open ? GateClass::mixed : GateClass::closed : open ? GateClass::open : GateClass::always;
}

bool GateSets::assign(const std::vector<uint32_t>& first, const std::vector<GateEntry>& entries) {
  *this = {};
  if (first.size() < 2 || first[0] != 0 || first[1] != 0 || first.back() != entries.size()) return false;
  for (size_t set = 1; set + 1 < first.size(); ++set) {
    if (first[set + 1] <= first[set] || first[set + 1] > entries.size()) return false;
    const auto of_set = std::span(entries).subspan(first[set], first[set + 1] - first[set]);
    if (number(of_set) != set || !std::ranges::equal((*this)[uint32_t(set)], of_set)) return false;
  }
  return true;
}

std::vector<uint32_t> addSets(const GateSets& from, GateSets& sets) {
  std::vector<uint32_t> number(from.count());
  for (uint32_t set = 0; set < from.count(); ++set) number[set] = sets.number(from[set]);
  return number;
}

GateSets sortSets(const GateSets& sets, std::vector<uint32_t>& used) {
  std::vector<uint32_t> number(sets.count(), 0);
  for (const uint32_t set : used) number[set] = 1;
  std::vector<uint32_t> order;
  for (uint32_t set = 1; set < sets.count(); ++set)
    if (number[set]) order.push_back(set);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return std::ranges::lexicographical_compare(sets[a], sets[b]); });
  GateSets sorted;
  number[0] = 0;
  for (const uint32_t set : order) number[set] = sorted.number(sets[set]);
  for (uint32_t& set : used) set = number[set];
  return sorted;
}

}  // namespace lightwell::transport
