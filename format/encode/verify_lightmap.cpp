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
  if (texel) checkTexels(context, kSection, *texel);
}

}  // namespace lightwell::format
