// Links that send as much as is received.
#include <algorithm>
#include <array>

#include "precompute/transport/radiosity/links.h"

namespace lightwell::transport {
namespace {

constexpr int kBalanceSweeps = 16;
constexpr double kMostGain = 2;  // of a sweep

/// The class that sets have to the other end of a link: with the gate of the row's leaf, without that of the node's.
class SenderClasses {
 public:
  SenderClasses(const PortalZones& zones, const Patches& patches, const PatchTree& tree, const GateSets& sets)
      : zones_(zones), patches_(patches), tree_(tree), sets_(sets) {
    for (uint32_t set = 0; set < sets.count(); ++set) class_.push_back(sets.classOf(set));
  }
  GateClass rowClass(uint32_t set) const { return class_[set]; }
  GateClass of(uint32_t row, uint32_t set, uint32_t node) const {
    const PortalZone &receiver = patches_.zone[row], &sender = patches_.zone[tree_.first_patch[node]];
    if (receiver.kind != PortalZone::leaf && sender.kind != PortalZone::leaf) return class_[set];
    bool closed = receiver.kind == PortalZone::leaf, open = false, left_out = sender.kind != PortalZone::leaf;
    for (const GateEntry entry : sets_[set]) {
      if (!left_out && isClosed(entry) && zones_.portalOf(entry / 2) == sender.portal) left_out = true;
      else (isClosed(entry) ? closed : open) = true;
    }
    // Two places on one strip have the same gate.
    if (!left_out && receiver.kind == PortalZone::leaf) closed = std::any_of(sets_[set].begin(), sets_[set].end(), isClosed);
    return closed ? open ? GateClass::mixed : GateClass::closed : open ? GateClass::open : GateClass::always;
  }

 private:
  const PortalZones& zones_;
  const Patches& patches_;
  const PatchTree& tree_;
  const GateSets& sets_;
  std::vector<GateClass> class_;
};

/// Classes of gates are balanced apart; without portals there is one.
template <size_t kClasses>
void balance(const PortalZones& zones, const Patches& patches, const PatchTree& tree, LinkValues& links) {
  const uint32_t rows = links.rows(), nodes = tree.nodeCount();
  const SenderClasses classes(zones, patches, tree, links.sets);
  const auto rowClass = [&](uint32_t l) { return kClasses == 1 ? size_t(0) : size_t(classes.rowClass(links.set[l])); };
  std::vector<uint8_t> sender_class(kClasses == 1 ? 0 : links.node.size());
  for (uint32_t row = 0; kClasses > 1 && row < rows; ++row)
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) sender_class[l] = uint8_t(classes.of(row, links.set[l], links.node[l]));
  const auto senderAt = [&](uint32_t l) { return links.node[l] * kClasses + (kClasses == 1 ? 0 : sender_class[l]); };
  using Sums = std::array<double, kClasses>;
  std::vector<Sums> row_sum(rows, Sums{});
  for (uint32_t row = 0; row < rows; ++row)
    for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) row_sum[row][rowClass(l)] += links.value[l];
  for (int sweep = 0; sweep < kBalanceSweeps; ++sweep) {
    // What all patches together receive per area of each node's surface, at the node and from the nodes above it.
    std::vector<double> density(nodes * kClasses, 0.0), gain(nodes * kClasses, 0.0);
    for (uint32_t row = 0; row < rows; ++row)
      for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l)
        density[senderAt(l)] += double(tree.area[row]) * links.value[l] / tree.area[links.node[l]];
    for (uint32_t node = nodes; node-- > rows;)
      for (uint32_t child = tree.first_child[node - rows]; child < tree.first_child[node - rows + 1]; ++child)
        for (size_t c = 0; c < kClasses; ++c) density[child * kClasses + c] += density[node * kClasses + c];
    for (uint32_t patch = 0; patch < rows; ++patch)
      for (size_t c = 0; c < kClasses; ++c) {
        const double sent = density[patch * kClasses + c];
        gain[patch * kClasses + c] = sent > 0 ? std::clamp(row_sum[patch][c] / sent, 1 / kMostGain, kMostGain) : 1.0;
      }
    for (uint32_t node = rows; node < nodes; ++node)
      for (size_t c = 0; c < kClasses; ++c) {
        double& mean = gain[node * kClasses + c];
        for (uint32_t child = tree.first_child[node - rows]; child < tree.first_child[node - rows + 1]; ++child)
          mean += gain[child * kClasses + c] * tree.area[child];
        mean /= tree.area[node];
      }
    for (uint32_t row = 0; row < rows; ++row) {
      Sums sum{};
      for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l) sum[rowClass(l)] += links.value[l] * gain[senderAt(l)];
      for (uint32_t l = links.first[row]; l < links.first[row + 1]; ++l)
        links.value[l] = float(links.value[l] * gain[senderAt(l)] * (row_sum[row][rowClass(l)] / sum[rowClass(l)]));
    }
  }
}

}  // namespace

void balanceLinks(const PortalZones& zones, const Patches& patches, const PatchTree& tree, LinkValues& links) {
  if (links.set.empty()) balance<1>(zones, patches, tree, links);
  else balance<kGateClasses>(zones, patches, tree, links);
}

}  // namespace lightwell::transport
