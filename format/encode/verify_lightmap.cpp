// The checks of section lightmap. docs/format.md has the table that they hold.
#include <string>

#include "format/encode/verify_context.h"
#include "lightwell/v1/container.pb.h"

namespace lightwell::format {

namespace {

constexpr const char* kSection = "lightmap";

}  // namespace

void verifyLightmap(VerifyContext& context) {
  v1::LightmapHeader header;
  if (!context.loadMessage(kSection, "header", header)) return;
  if (header.texels() == 0) return context.report(IssueId::header_value, kSection, "header", "there are no texels");
  const uint64_t texels = header.texels();
  if (header.has_direct()) context.load<uint32_t>(kSection, "direct", ElementType::rgb9e5, {texels});
  if (header.has_indirect()) context.load<uint32_t>(kSection, "indirect", ElementType::rgb9e5, {texels});
  const auto texel = context.load<uint32_t>(kSection, "texel", {texels});
  if (!texel || !context.find("atlas", "coverage")) return;
  const auto coverage = context.load<uint8_t>("atlas", "coverage", {kAnyExtent, kAnyExtent});
  for (size_t i = 0; coverage && i < texel->size(); ++i) {
    const std::string place = "value " + std::to_string(i);
    if ((*texel)[i] >= coverage->size()) return context.report(IssueId::index_range, kSection, "texel", place + " belongs to no texel of the atlas");
    if (i > 0 && (*texel)[i] <= (*texel)[i - 1]) return context.report(IssueId::order, kSection, "texel", place + " does not ascend");
    if (!(*coverage)[(*texel)[i]]) return context.report(IssueId::cross_section, kSection, "texel", place + " belongs to a texel that is not covered");
  }
}

}  // namespace lightwell::format
