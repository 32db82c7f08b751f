// The checks of section probes. docs/format.md has the table that they hold.
#include <cmath>
#include <string>

#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

constexpr const char* kSection = "probes";
constexpr uint64_t kNearnessNodes = 289, kMostLatticePoints = uint64_t(1) << 22, kMostProbes = uint64_t(1) << 22;

double linkWeight(uint8_t code) { return double((16u + (code & 15u)) << (code >> 4)); }

uint64_t nodeCount(uint64_t patches) {
  uint64_t nodes = patches;
  for (uint64_t level = patches; level > 8;) nodes += level = (level + 7) / 8;
  return nodes;
}

class ProbesChecks {
 public:
  ProbesChecks(VerifyContext& context, const v1::ProbesHeader& header, const v1::RadiosityHeader& radiosity)
      : context_(context), header_(header), radiosity_(radiosity), on_lattice_(header.lattice_probes()), probes_(on_lattice_ + header.points()) {
    for (const auto& portal : radiosity.portals()) gates_ += portal.strips();
  }

  void run() {
    if (!header()) return;
    places();
    gateSets();
    links();
  }

 private:
  void wrong(IssueId id, const char* name, std::string message) { context_.report(id, kSection, name, std::move(message)); }

  bool header() {
    const auto bad = [&](const std::string& message) {
      wrong(IssueId::header_value, "header", message);
      return false;
    };
    if (probes_ == 0 || probes_ > kMostProbes) return bad("the number of probes is not between 1 and 2^22");
    const int counts = header_.lattice_count_size();
    if ((counts != 0 && counts != 3) || header_.lattice_first_size() != counts) return bad("the lattice has neither three dimensions nor none");
    if (counts == 0) return on_lattice_ == 0 || bad("there are probes on a lattice, but no lattice");
    if (!(header_.lattice_spacing() > 0) || !std::isfinite(header_.lattice_spacing())) return bad("the lattice's spacing is not positive and finite");
    for (const float first : header_.lattice_first())
      if (!std::isfinite(first)) return bad("the lattice's place is not finite");
    lattice_points_ = 1;
    for (const uint64_t count : header_.lattice_count()) {
      if (count == 0 || count > kMostLatticePoints || (lattice_points_ *= count) > kMostLatticePoints) return bad("the lattice has no points, or more than 2^22");
    }
    return true;
  }

  void places() {
    if (header_.points() > 0)
      if (const auto position = context_.load<float>(kSection, "point_position", {header_.points(), 3})) context_.checkFinite(*position, kSection, "point_position");
    if (lattice_points_ == 0) return;
    if (const auto point = context_.load<uint32_t>(kSection, "lattice_point", {on_lattice_}))
      if (context_.checkEach(*point, IssueId::index_range, kSection, "lattice_point", "are beyond the lattice", [&](uint32_t v) { return v >= lattice_points_; }))
        for (size_t i = 1; i < point->size(); ++i)
          if ((*point)[i] <= (*point)[i - 1]) {
            wrong(IssueId::order, "lattice_point", "probe " + std::to_string(i) + " does not ascend");
            break;
          }
    if (const auto offset = context_.load<int8_t>(kSection, "offset", {on_lattice_, 3}))
      context_.checkEach(*offset, IssueId::value_range, kSection, "offset", "are -128", [](int8_t v) { return v == INT8_MIN; });
    context_.load<uint8_t>(kSection, "nearness", {on_lattice_, kNearnessNodes});
  }

  void gateSets() {
    if (!context_.find(kSection, "link_gates")) return;
    GateSetChunks sets = loadGateSets(context_, kSection, gates_);
    set_first_ = std::move(sets.first);
    sets_good_ = sets.good;
  }

  void links() {
    const auto node = context_.load<uint32_t>(kSection, "link_node", {kAnyExtent});
    const auto first = context_.load<uint32_t>(kSection, "link_first", {probes_ + 1});
    const uint64_t count = node ? node->size() : kAnyExtent;
    const auto code = context_.load<uint8_t>(kSection, "link_code", {count});
    const auto scale = context_.load<float>(kSection, "scale", {probes_});
    const bool gated = context_.find(kSection, "link_gates") != nullptr;
    std::optional<std::vector<uint16_t>> gates;
    if (gated) gates = context_.load<uint16_t>(kSection, "link_gates", {count});
    if (!node || !first || !code || !scale || (gated && (!gates || !sets_good_))) return;
    const uint64_t nodes = nodeCount(radiosity_.patches());
    bool sound = context_.checkOffsets(*first, count, false, kSection, "link_first");
    sound &= context_.checkEach(*scale, IssueId::not_finite, kSection, "scale", "are negative or not finite", [](float v) { return !(v >= 0) || !std::isfinite(v); });
    sound &= context_.checkEach(*node, IssueId::index_range, kSection, "link_node", "name no patch or node", [&](uint32_t v) { return v >= nodes; });
    if (gates)
      sound &= context_.checkEach(*gates, IssueId::index_range, kSection, "link_gates", "name no gate set", [&](uint16_t v) { return v + 1u >= set_first_->size(); });
    if (!sound) return;
    for (uint64_t probe = 0; probe < probes_; ++probe) {
      double sum = 0;
      for (uint32_t l = (*first)[probe]; l < (*first)[probe + 1]; ++l) {
        if (!gates || (*gates)[l] == 0) sum += linkWeight((*code)[l]);
        if (l == (*first)[probe]) continue;
        const bool same_set = !gates || (*gates)[l] == (*gates)[l - 1];
        if (!(same_set ? (*node)[l] > (*node)[l - 1] : (*gates)[l] > (*gates)[l - 1]))
          return wrong(IssueId::order, "link_node", "link " + std::to_string(l) + " does not ascend within its probe and gate set, or the sets do not");
      }
      if (sum * double((*scale)[probe]) > 1 + 1e-3)
        return wrong(IssueId::weight_sum, "scale", "the links of probe " + std::to_string(probe) + " sum to " + std::to_string(sum * double((*scale)[probe])) +
                                                       ", more than the sphere");
    }
  }

  VerifyContext& context_;
  const v1::ProbesHeader& header_;
  const v1::RadiosityHeader& radiosity_;
  const uint64_t on_lattice_, probes_;
  uint64_t lattice_points_ = 0, gates_ = 0;
  std::optional<std::vector<uint32_t>> set_first_;
  bool sets_good_ = false;
};

}  // namespace

void verifyProbes(VerifyContext& context) {
  if (!context.has("radiosity")) return context.report(IssueId::section_missing, kSection, "", "needs section radiosity");
  v1::ProbesHeader header;
  v1::RadiosityHeader radiosity;
  if (context.loadMessage(kSection, "header", header) && context.loadMessage("radiosity", "header", radiosity)) ProbesChecks(context, header, radiosity).run();
}

}  // namespace lightwell::format
