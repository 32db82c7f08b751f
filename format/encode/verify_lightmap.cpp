// The checks of section lightmap. docs/format.md has the table that they hold.
#include <string>
#include <tuple>

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
  if (header.unit() != 0 && !(header.unit() >= 0x1p-126f && header.unit() <= 0x1p126f)) context.report(IssueId::header_value, kSection, "header", "the unit is out of range");
  const uint64_t texels = header.texels();
  if (header.has_direct()) context.load<uint32_t>(kSection, "direct", ElementType::rgb9e5, {texels});
  if (header.has_indirect()) context.load<uint32_t>(kSection, "indirect", ElementType::rgb9e5, {texels});
  for (const auto& [name, has_gradient, has_light] : {std::tuple{"direct_gradient", header.has_direct_gradient(), header.has_direct()},
                                                      std::tuple{"indirect_gradient", header.has_indirect_gradient(), header.has_indirect()}}) {
    if (!has_gradient) continue;
    if (!has_light) context.report(IssueId::header_value, kSection, "header", std::string("there is no light that ") + name + " could belong to");
    const auto values = context.load<int8_t>(kSection, name, {texels, 3});
    if (values) context.checkEach(*values, IssueId::value_range, kSection, name, "are below -127", [](int8_t value) { return value < -127; });
  }
  const auto texel = context.load<uint32_t>(kSection, "texel", {texels});
  if (texel) checkTexels(context, kSection, *texel);
}

}  // namespace lightwell::format
