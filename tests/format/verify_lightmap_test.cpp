// Each invariant of the section lightmap, broken once: verify names the chunk and the issue, and nothing else is wrong with the file.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/format/breach.h"
#include "tests/format/lightmap_content.h"

namespace lightwell::format {
namespace {

using Breach = BreachOf<LightmapContent>;

const std::vector<Breach>& breaches() {
  using C = LightmapContent;
  static const std::vector<Breach> all = {
      {"NoTexels", IssueId::header_value, "lightmap/header", [](C& c) { c.header.clear_texels(); }},
      {"UnitNegative", IssueId::header_value, "lightmap/header", [](C& c) { c.header.set_unit(-1); }},
      {"UnitInfinite", IssueId::header_value, "lightmap/header", [](C& c) { c.header.set_unit(HUGE_VALF); }},
      {"TexelOutside", IssueId::index_range, "lightmap/texel", [](C& c) { c.texel[2] = 16; }},
      {"TexelTwice", IssueId::order, "lightmap/texel", [](C& c) { c.texel[1] = 0; }},
      {"TexelUncovered", IssueId::cross_section, "lightmap/texel", [](C& c) { c.texel[2] = 5; }},
      {"DirectMissing", IssueId::chunk_missing, "lightmap/direct", [](C& c) { c.direct.clear(); }},
      {"IndirectShort", IssueId::chunk_shape, "lightmap/indirect", [](C& c) { c.indirect.pop_back(); }},
  };
  return all;
}

TEST(VerifyLightmap, FindsNothingWrong) {
  EXPECT_EQ(listed(issuesOf(lightmapContent())), "");
  LightmapContent dark = lightmapContent();
  dark.header.set_has_direct(false);
  dark.direct.clear();
  EXPECT_EQ(listed(issuesOf(dark)), "");
}

std::vector<Breach> directionalBreaches() {
  using C = LightmapContent;
  return {
      {"GradientMissing", IssueId::chunk_missing, "lightmap/direct_gradient", [](C& c) { c.direct_gradient.clear(); }},
      {"GradientShort", IssueId::chunk_shape, "lightmap/indirect_gradient", [](C& c) { c.indirect_gradient.resize(6); }},
      {"GradientBelow", IssueId::value_range, "lightmap/indirect_gradient", [](C& c) { c.indirect_gradient[4] = -128; }},
      {"GradientOfNothing", IssueId::header_value, "lightmap/header", [](C& c) { c.header.clear_has_direct(), c.direct.clear(); }},
  };
}

class VerifyLightmapBreach : public testing::TestWithParam<Breach> {};

TEST_P(VerifyLightmapBreach, IsNamed) { expectNamed(GetParam(), lightmapContent()); }

INSTANTIATE_TEST_SUITE_P(All, VerifyLightmapBreach, testing::ValuesIn(breaches()), [](const auto& info) { return std::string(info.param.name); });

class VerifyDirectionalBreach : public testing::TestWithParam<Breach> {};

TEST_P(VerifyDirectionalBreach, IsNamed) { expectNamed(GetParam(), directionalContent()); }

INSTANTIATE_TEST_SUITE_P(All, VerifyDirectionalBreach, testing::ValuesIn(directionalBreaches()), [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace lightwell::format
