// The checks of section radiosity. docs/format.md has the table that they hold.
#include <cmath>
#include <string>

#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

constexpr const char* kSection = "radiosity";
constexpr uint32_t kNone = 0xffffffffu;
constexpr uint64_t kMostMaterials = 65536, kMostGates = 32768, kMostNodes = uint64_t(1) << 24;

double linkWeight(uint8_t code) { return double((16u + (code & 15u)) << (code >> 4)); }

uint64_t nodeCount(uint64_t patches) {
  uint64_t nodes = patches;
  for (uint64_t level = patches; level > 8;) nodes += level = (level + 7) / 8;
  return nodes;
}

bool isNegativeOrNotFinite(float v) { return !(v >= 0) || !std::isfinite(v); }

class RadiosityChecks {
 public:
  RadiosityChecks(VerifyContext& context, const v1::RadiosityHeader& header) : context_(context), header_(header), patches_(header.patches()) {}

  void run() {
    if (!header()) return;
    patches();
    gateSets();
    links();
    texels();
  }

 private:
  void wrong(IssueId id, const char* name, std::string message) { context_.report(id, kSection, name, std::move(message)); }

  bool header() {
    const auto bad = [&](const std::string& message) {
      wrong(IssueId::header_value, "header", message);
      return false;
    };
    if (patches_ == 0 || header_.texels() == 0) return bad("there are no patches or no texels");
    if (nodeCount(patches_) > kMostNodes) return bad("more than 2^24 patches and nodes");
    if (header_.materials_size() == 0 || uint64_t(header_.materials_size()) > kMostMaterials) return bad("the number of materials is not between 1 and 65536");
    for (int i = 0; i < header_.portals_size(); ++i) {
      const v1::RadiosityPortal& portal = header_.portals(i);
      const std::string place = "portal " + std::to_string(i);
      if (portal.first_gate() != gates_ || portal.strips() == 0) return bad(place + " has no strips, or they do not follow those before");
      gates_ += portal.strips();
      if (gates_ > kMostGates) return bad("more than 32768 gates");
      if (!isLeaf(portal)) return bad(place + " has triangles without an axis, or an axis that is zero or not finite");
    }
    return leaves();
  }

  static bool isLeaf(const v1::RadiosityPortal& portal) {
    if (portal.axis_size() != (portal.triangles() ? 3 : 0) || !std::isfinite(portal.offset())) return false;
    double length2 = 0;
    for (const float a : portal.axis()) length2 += double(a) * double(a);
    return portal.triangles() == 0 || (length2 > 0 && std::isfinite(length2));
  }

  bool leaves() {
    const ChunkInfo* index = context_.find("geometry", "index");
    uint64_t end = 0;
    for (int i = 0; i < header_.portals_size(); ++i) {
      const v1::RadiosityPortal& portal = header_.portals(i);
      if (portal.triangles() == 0) continue;
      const bool after = portal.first_triangle() >= end;
      end = uint64_t(portal.first_triangle()) + portal.triangles();
      if (after && (!index || end <= index->elements / 3)) continue;
      wrong(IssueId::cross_section, "header", "portal " + std::to_string(i) + " has triangles that are another portal's, or not there");
      return false;
    }
    return true;
  }

  void patches() {
    if (const auto area = context_.load<float>(kSection, "patch_area", {patches_}))
      context_.checkEach(*area, IssueId::value_range, kSection, "patch_area", "are not positive and finite", [](float v) { return !(v > 0) || !std::isfinite(v); });
    if (const auto position = context_.load<float>(kSection, "patch_position", {patches_, 3})) context_.checkFinite(*position, kSection, "patch_position");
    if (const auto normal = context_.load<int16_t>(kSection, "patch_normal", {patches_, 2}))
      context_.checkEach(*normal, IssueId::value_range, kSection, "patch_normal", "are -32768", [](int16_t v) { return v == INT16_MIN; });
    if (const auto material = context_.load<uint16_t>(kSection, "patch_material", {patches_}))
      context_.checkEach(*material, IssueId::index_range, kSection, "patch_material", "name no material", [&](uint16_t v) { return v >= header_.materials_size(); });
    if (const auto albedo = context_.load<float>(kSection, "patch_albedo", {patches_, 3}))
      context_.checkEach(*albedo, IssueId::value_range, kSection, "patch_albedo", "are not between 0 and 0.999", [](float v) { return !(v >= 0 && v <= 0.999f); });
    if (header_.has_emission()) context_.load<uint32_t>(kSection, "patch_emission", ElementType::rgb9e5, {patches_});
  }

  void gateSets() {
    if (gates_ == 0) return;
    GateSetChunks sets = loadGateSets(context_, kSection, gates_);
    set_first_ = std::move(sets.first);
    set_ = std::move(sets.entry);
    sets_good_ = sets.good;
  }

  void links() {
    const auto node = context_.load<uint32_t>(kSection, "link_node", {kAnyExtent});
    const auto first = context_.load<uint32_t>(kSection, "link_first", {patches_ + 1});
    const uint64_t count = node ? node->size() : kAnyExtent;
    const auto code = context_.load<uint8_t>(kSection, "link_code", {count});
    const auto scale = context_.load<float>(kSection, "row_scale", {patches_});
    std::optional<std::vector<uint16_t>> gates;
    if (gates_ > 0) gates = context_.load<uint16_t>(kSection, "link_gates", {count});
    if (!node || !first || !code || !scale || (gates_ > 0 && (!gates || !sets_good_))) return;
    const uint64_t nodes = nodeCount(patches_);
    bool sound = context_.checkOffsets(*first, count, false, kSection, "link_first");
    sound &= context_.checkEach(*scale, IssueId::not_finite, kSection, "row_scale", "are negative or not finite", isNegativeOrNotFinite);
    sound &= context_.checkEach(*node, IssueId::index_range, kSection, "link_node", "name no patch or node", [&](uint32_t v) { return v >= nodes; });
    if (gates)
      sound &= context_.checkEach(*gates, IssueId::index_range, kSection, "link_gates", "name no gate set", [&](uint16_t v) { return v + 1u >= set_first_->size(); });
    if (!sound) return;
    for (uint64_t row = 0; row < patches_; ++row) {
      for (uint32_t l = (*first)[row] + 1; l < (*first)[row + 1]; ++l) {
        const bool same_set = !gates || (*gates)[l] == (*gates)[l - 1];
        if (same_set ? (*node)[l] > (*node)[l - 1] : (*gates)[l] > (*gates)[l - 1]) continue;
        return wrong(IssueId::order, "link_node", "link " + std::to_string(l) + " does not ascend within its row and gate set, or the sets do not");
      }
    }
    // More than all light is received in no state of the doors: with every one open, and with every one closed.
    for (const bool closed : {false, true})
      for (uint64_t row = 0; row < patches_; ++row) {
        double sum = 0;
        for (uint32_t l = (*first)[row]; l < (*first)[row + 1]; ++l)
          if (!gates || counts((*gates)[l], closed)) sum += linkWeight((*code)[l]);
        if (sum * double((*scale)[row]) <= 1 + 1e-4) continue;
        return wrong(IssueId::weight_sum, "row_scale", "the links of patch " + std::to_string(row) + " sum to " + std::to_string(sum * double((*scale)[row])) +
                                                            ", more than 1" + (gates ? closed ? ", with all portals closed" : ", with all portals open" : ""));
      }
  }

  /// Whether a link with this gate set counts when all gates are closed or open.
  bool counts(uint16_t set, bool closed) const {
    for (uint32_t e = (*set_first_)[set]; e < (*set_first_)[set + 1]; ++e)
      if (((*set_)[e] & 1u) != uint32_t(closed)) return false;
    return true;
  }

  void texels() {
    const uint64_t texels = header_.texels();
    const auto texel = context_.load<uint32_t>(kSection, "texel", {texels});
    const auto patch = context_.load<uint32_t>(kSection, "texel_patch", {texels, 4});
    const auto weight = context_.load<uint8_t>(kSection, "texel_weight", {texels, 4});
    context_.load<uint8_t>(kSection, "texel_exposed", {texels});
    if (header_.has_backs())
      if (const auto back = context_.load<uint32_t>(kSection, "texel_back_patch", {texels}))
        context_.checkEach(*back, IssueId::index_range, kSection, "texel_back_patch", "name no patch", [&](uint32_t v) { return v >= patches_ && v != kNone; });
    if (patch) context_.checkEach(*patch, IssueId::index_range, kSection, "texel_patch", "name no patch", [&](uint32_t v) { return v >= patches_ && v != kNone; });
    for (uint64_t i = 0; patch && weight && i < texels; ++i) {
      const uint32_t* p = &(*patch)[i * 4];
      const uint8_t* w = &(*weight)[i * 4];
      const std::string place = "texel " + std::to_string(i);
      if (p[0] == kNone) return wrong(IssueId::index_range, "texel_patch", place + " belongs to no patch");
      if (w[0] + w[1] + w[2] + w[3] != 255) return wrong(IssueId::weight_sum, "texel_weight", "the weights of " + place + " do not sum to 255");
      for (int k = 0; k < 4; ++k)
        if (p[k] == kNone && w[k] != 0) return wrong(IssueId::value_range, "texel_weight", place + " gives weight to no patch");
    }
    if (texel) checkTexels(context_, kSection, *texel);
  }

  VerifyContext& context_;
  const v1::RadiosityHeader& header_;
  const uint64_t patches_;
  uint64_t gates_ = 0;
  std::optional<std::vector<uint32_t>> set_first_;
  std::optional<std::vector<uint16_t>> set_;
  bool sets_good_ = false;
};

}  // namespace

void verifyRadiosity(VerifyContext& context) {
  for (const char* needed : {"scene", "atlas", "geometry"})
    if (!context.has(needed)) context.report(IssueId::section_missing, kSection, "", std::string("needs section ") + needed);
  v1::RadiosityHeader header;
  if (context.loadMessage(kSection, "header", header)) RadiosityChecks(context, header).run();
}

}  // namespace lightwell::format
