// Checks that several sections have in common.
#include <string>

#include "format/encode/verify_context.h"

namespace lightwell::format {

void checkTexels(VerifyContext& context, std::string_view section, const std::vector<uint32_t>& texel) {
  if (!context.find("atlas", "coverage")) return;
  const auto coverage = context.load<uint8_t>("atlas", "coverage", {kAnyExtent, kAnyExtent});
  for (size_t i = 0; coverage && i < texel.size(); ++i) {
    const std::string place = "value " + std::to_string(i);
    if (texel[i] >= coverage->size()) return context.report(IssueId::index_range, section, "texel", place + " belongs to no texel of the atlas");
    if (i > 0 && texel[i] <= texel[i - 1]) return context.report(IssueId::order, section, "texel", place + " does not ascend");
    if (!(*coverage)[texel[i]]) return context.report(IssueId::cross_section, section, "texel", place + " belongs to a texel that is not covered");
  }
}

GateSetChunks loadGateSets(VerifyContext& context, std::string_view section, uint64_t gates) {
  GateSetChunks sets;
  sets.first = context.load<uint32_t>(section, "gate_set_first", {kAnyExtent});
  sets.entry = context.load<uint16_t>(section, "gate_set", {kAnyExtent});
  if (!sets.first || !sets.entry || !context.checkOffsets(*sets.first, sets.entry->size(), false, section, "gate_set_first")) return sets;
  const std::vector<uint32_t>& first = *sets.first;
  const std::vector<uint16_t>& entry = *sets.entry;
  if (first.size() < 2 || first.size() > 65537 || first[1] != 0) {
    context.report(IssueId::value_range, section, "gate_set_first", "the number of sets is not between 1 and 65536, or set 0 is not empty");
    return sets;
  }
  sets.good = context.checkEach(entry, IssueId::index_range, section, "gate_set", "name no gate", [&](uint16_t v) { return v / 2 >= gates; });
  for (size_t s = 0; sets.good && s + 1 < first.size(); ++s)
    for (uint32_t e = first[s] + 1; sets.good && e < first[s + 1]; ++e)
      if (entry[e] <= entry[e - 1]) {
        sets.good = false;
        context.report(IssueId::order, section, "gate_set", "set " + std::to_string(s) + " does not ascend");
      }
  return sets;
}

}  // namespace lightwell::format
