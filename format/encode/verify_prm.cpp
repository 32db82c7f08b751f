// The checks of sections prm and prm_probes. docs/format.md has the tables that they hold.
#include <algorithm>
#include <cmath>
#include <string>

#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {
namespace {

constexpr const char* kSection = "prm";

bool isNegativeOrNotFinite(float v) { return !(v >= 0) || !std::isfinite(v); }

void verifyEntries(VerifyContext& context, const v1::PrmHeader& prm) {
  const uint64_t entries = prm.entries();
  if (const auto position = context.load<float>(kSection, "entry_position", {entries, 3}))
    context.checkFinite(*position, kSection, "entry_position");
  if (const auto normal = context.load<int16_t>(kSection, "entry_normal", {entries, 2}))
    context.checkEach(*normal, IssueId::value_range, kSection, "entry_normal", "are -32768", [](int16_t v) { return v == INT16_MIN; });
  const auto weight = context.load<float>(kSection, "entry_weight", {entries});
  const auto first = context.load<uint32_t>(kSection, "cluster_first_entry", {uint64_t(prm.clusters()) + 1});
  const bool weights_good = weight && context.checkEach(*weight, IssueId::not_finite, kSection, "entry_weight",
                                                        "are negative or not finite", isNegativeOrNotFinite);
  const bool offsets_good = first && context.checkOffsets(*first, entries, true, kSection, "cluster_first_entry");
  if (!weights_good || !offsets_good) return;
  for (size_t cluster = 0; cluster + 1 < first->size(); ++cluster) {
    double sum = 0;
    for (uint32_t i = (*first)[cluster]; i < (*first)[cluster + 1]; ++i) sum += (*weight)[i];
    if (std::abs(sum - 1) <= 1e-4) continue;
    context.report(IssueId::weight_sum, kSection, "entry_weight",
                   "the weights of cluster " + std::to_string(cluster) + " sum to " + std::to_string(sum) + " instead of 1");
    return;
  }
}

void verifyTexels(VerifyContext& context, const v1::PrmHeader& prm) {
  const auto texel = context.load<uint32_t>(kSection, "texel", {prm.texels()});
  const ChunkInfo* coverage_chunk = context.find("atlas", "coverage");
  if (!texel || !coverage_chunk) return;
  const auto coverage = context.load<uint8_t>("atlas", "coverage", {kAnyExtent, kAnyExtent});
  if (!coverage) return;
  std::vector<bool> seen(coverage->size());
  for (size_t i = 0; i < texel->size(); ++i) {
    const uint32_t t = (*texel)[i];
    const std::string place = "value " + std::to_string(i);
    if (t >= seen.size()) return context.report(IssueId::index_range, kSection, "texel", place + " belongs to no texel of the atlas");
    if (seen[t]) return context.report(IssueId::order, kSection, "texel", place + " belongs to a texel that has one already");
    if (!(*coverage)[t])
      return context.report(IssueId::cross_section, kSection, "texel", place + " belongs to a texel that is not covered");
    seen[t] = true;
  }
}

void verifyPanes(VerifyContext& context, const v1::PrmHeader& prm) {
  const uint64_t clusters = prm.clusters(), texels = prm.texels();
  if (prm.brightest() > clusters) context.report(IssueId::header_value, kSection, "header", "brightest is more than there are clusters");
  if (prm.blocks() != 0 || prm.max_rank() != 0)
    context.report(IssueId::header_value, kSection, "header", "panes have no blocks and no rank");
  const ChunkInfo* pane = context.find(kSection, "pane");
  if (!pane || pane->element != ElementType::f16) {
    context.load<uint32_t>(kSection, "pane", ElementType::rgb9e5, {clusters, texels});
    return;
  }
  if (const auto halves = context.load<uint16_t>(kSection, "pane", ElementType::f16, {clusters, texels, 3}))
    context.checkEach(*halves, IssueId::not_finite, kSection, "pane", "are negative or not finite",
                      [](uint16_t v) { return v > 0x7bff && v != 0x8000; });
}

/// Every inner node splits its leaves in two, first to last in pre-order.
void verifyTree(VerifyContext& context, uint64_t clusters) {
  const auto first_leaves = context.load<uint32_t>(kSection, "tree_first_leaves", {clusters - 1});
  if (const auto share = context.load<uint16_t>(kSection, "tree_first_share", {clusters - 1}))
    context.checkEach(*share, IssueId::value_range, kSection, "tree_first_share", "are zero", [](uint16_t v) { return v == 0; });
  context.load<uint8_t>(kSection, "wavelet_unit", {3 * clusters - 2});
  if (!first_leaves) return;
  std::vector<uint64_t> waiting{clusters};  // leaves under the nodes that are still to come, the next one last
  for (size_t n = 0; n < first_leaves->size(); ++n) {
    const uint64_t leaves = waiting.back(), first = (*first_leaves)[n];
    waiting.pop_back();
    if (first == 0 || first >= leaves)
      return context.report(IssueId::value_range, kSection, "tree_first_leaves", "node " + std::to_string(n) + " does not split its leaves in two");
    if (leaves - first > 1) waiting.push_back(leaves - first);
    if (first > 1) waiting.push_back(first);
  }
}

void verifyRectangles(VerifyContext& context, uint64_t entries) {
  if (const auto halves = context.load<uint16_t>(kSection, "entry_rectangle", ElementType::f16, {entries, 3}))
    context.checkEach(*halves, IssueId::not_finite, kSection, "entry_rectangle", "are not finite", [](uint16_t v) { return (v & 0x7c00) == 0x7c00; });
}

/// Blocks with their basis maps and links: of texels, or a probe each. `first_value`: blocks + 1.
void verifyBlocks(VerifyContext& context, const char* section, uint64_t clusters, uint64_t max_rank, const std::vector<uint32_t>& first_value) {
  const uint64_t blocks = first_value.size() - 1;
  const auto rank = context.load<uint8_t>(section, "block_rank", {blocks});
  const auto link_wavelet = context.load<uint32_t>(section, "link_wavelet", {kAnyExtent});
  const auto first_link = context.load<uint32_t>(section, "block_first_link", {blocks + 1});
  if (!rank || !link_wavelet || !first_link) return;
  bool sound = context.checkOffsets(*first_link, link_wavelet->size(), false, section, "block_first_link");
  sound &= context.checkEach(*rank, IssueId::value_range, section, "block_rank", "are more than max_rank", [&](uint8_t v) { return v > max_rank; });
  context.checkEach(*link_wavelet, IssueId::index_range, section, "link_wavelet", "name no wavelet", [&](uint32_t v) { return v >= 3 * clusters - 2; });
  if (!sound) return;
  uint64_t basis_size = 0, scale_size = 0, coefficient_size = 0;
  bool ascending = true;
  for (uint64_t b = 0; b < blocks; ++b) {
    const uint64_t r = (*rank)[b];
    basis_size += uint64_t(first_value[b + 1] - first_value[b]) * r;
    scale_size += r * 3;
    coefficient_size += uint64_t((*first_link)[b + 1] - (*first_link)[b]) * r * 3;
    for (uint32_t l = (*first_link)[b] + 1; l < (*first_link)[b + 1] && ascending; ++l)
      if ((*link_wavelet)[l] < (*link_wavelet)[l - 1]) {
        context.report(IssueId::order, section, "link_wavelet", "link " + std::to_string(l) + " does not ascend within its block");
        ascending = false;
      }
  }
  if (const auto basis = context.load<int8_t>(section, "basis", {basis_size}))
    context.checkEach(*basis, IssueId::value_range, section, "basis", "are -128", [](int8_t v) { return v == INT8_MIN; });
  if (const auto scale = context.load<float>(section, "coefficient_scale", {scale_size}))
    context.checkEach(*scale, IssueId::not_finite, section, "coefficient_scale", "are negative or not finite", isNegativeOrNotFinite);
  context.load<int8_t>(section, "coefficient", {coefficient_size});
}

void verifyLocalBases(VerifyContext& context, const v1::PrmHeader& prm) {
  if (prm.clusters() == 0) return context.report(IssueId::header_value, kSection, "header", "there are no clusters");
  if (prm.blocks() == 0 || prm.blocks() > prm.texels() || prm.max_rank() == 0 || prm.max_rank() > 255)
    return context.report(IssueId::header_value, kSection, "header", "blocks is not 1 to texels, or max_rank not 1 to 255");
  verifyTree(context, prm.clusters());
  verifyRectangles(context, prm.entries());
  if (prm.brightest() != 0) context.report(IssueId::header_value, kSection, "header", "local bases have no brightest panes");
  const auto first_texel = context.load<uint32_t>(kSection, "block_first_texel", {uint64_t(prm.blocks()) + 1});
  if (first_texel && context.checkOffsets(*first_texel, prm.texels(), true, kSection, "block_first_texel"))
    verifyBlocks(context, kSection, prm.clusters(), prm.max_rank(), *first_texel);
}

}  // namespace

void verifyPrm(VerifyContext& context) {
  for (const char* needed : {"scene", "atlas"})
    if (!context.has(needed)) context.report(IssueId::section_missing, kSection, "", std::string("needs section ") + needed);
  v1::PrmHeader prm;
  if (!context.loadMessage(kSection, "header", prm)) return;
  verifyEntries(context, prm);
  verifyTexels(context, prm);
  if (prm.layout() == v1::PRM_LAYOUT_PANES) verifyPanes(context, prm);
  else if (prm.layout() == v1::PRM_LAYOUT_LOCAL_BASES) verifyLocalBases(context, prm);
  else context.report(IssueId::header_value, kSection, "header", "the layout is not one of this version");
  if (prm.has_emitter())
    for (const char* name : {"emitter_direct", "emitter_indirect"})
      context.load<uint32_t>(kSection, name, ElementType::rgb9e5, {prm.texels()});
  if (!prm.has_sky()) return;
  int exponent = 0;
  if (!(prm.sky_scale() > 0) || !(prm.sky_scale() <= 0x1p60f) || std::frexp(prm.sky_scale(), &exponent) != 0.5f)
    context.report(IssueId::header_value, kSection, "header", "sky_scale is not a power of two up to 2^60");
  for (const char* name : {"sky_direct", "sky_indirect"}) context.load<uint32_t>(kSection, name, ElementType::rgb9e5, {prm.texels()});
}

void verifyPrmProbes(VerifyContext& context) {
  constexpr const char* kProbes = "prm_probes";
  constexpr uint32_t kValues = 12, kMostProbes = 1u << 22;
  v1::PrmProbesHeader header;
  if (!context.loadMessage(kProbes, "header", header)) return;
  if (header.probes() == 0 || header.probes() > kMostProbes || header.max_rank() > kValues)
    return context.report(IssueId::header_value, kProbes, "header", "probes is not 1 to 2^22, or max_rank more than 12");
  if (const auto position = context.load<float>(kProbes, "position", {header.probes(), 3})) context.checkFinite(*position, kProbes, "position");
  if (header.has_emitter())
    if (const auto halves = context.load<uint16_t>(kProbes, "emitter", ElementType::f16, {header.probes(), 9, 3}))
      context.checkEach(*halves, IssueId::not_finite, kProbes, "emitter", "are not finite", [](uint16_t v) { return (v & 0x7c00) == 0x7c00; });
  if (!context.has(kSection)) return context.report(IssueId::section_missing, kProbes, "", "needs section prm");
  v1::PrmHeader prm;
  if (!context.loadMessage(kSection, "header", prm)) return;
  if (prm.layout() != v1::PRM_LAYOUT_LOCAL_BASES || prm.clusters() == 0)
    return context.report(IssueId::cross_section, kProbes, "header", "section prm has no local bases");
  std::vector<uint32_t> first_value;
  for (uint32_t i = 0; i <= header.probes(); ++i) first_value.push_back(i * kValues);
  verifyBlocks(context, kProbes, prm.clusters(), header.max_rank(), first_value);
}

}  // namespace lightwell::format
